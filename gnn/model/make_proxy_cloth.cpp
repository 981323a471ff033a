#include "gnn/model/make_proxy_cloth.h"

#include <utility>

#include "gnn/model/network_start.h"

namespace cloth {

ProxyClothSettings ProxyClothSettings::learned(std::shared_ptr<const EngineWeights> weights) {
    ProxyClothSettings settings;
    settings.proxy.weights = std::move(weights);
    settings.proxy.step = StepSettings::in_small_steps(60.0, 2);
    settings.proxy.small_steps_from_network = true;
    settings.embedded.detail_iterations = 0;
    return settings;
}

std::unique_ptr<EmbeddedStepper> make_proxy_cloth(const Garment& fine,
                                                  std::shared_ptr<const Garment> proxy,
                                                  const ProxyClothSettings& settings) {
    std::unique_ptr<Stepper> stepper;
    if (proxy) stepper = make_cloth(*proxy, settings.proxy);
    std::shared_ptr<StepStart> network;
    if (settings.detail)
        network = std::make_shared<NetworkStart>(
            fine, std::make_shared<Engine>(settings.detail, settings.engine));
    return std::make_unique<EmbeddedStepper>(fine, std::move(proxy), std::move(stepper),
                                             settings.embedded, network);
}

}  // namespace cloth
