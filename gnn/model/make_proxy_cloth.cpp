#include "gnn/model/make_proxy_cloth.h"

#include <utility>

#include "gnn/model/network_start.h"

namespace cloth {

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
