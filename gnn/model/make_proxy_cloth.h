#pragma once

#include <memory>

#include "gnn/model/make_cloth.h"
#include "gnn/physics/stepper/embedded_stepper.h"

namespace cloth {

struct ProxyClothSettings {
    ClothSettings proxy;  ///< how the proxy is simulated
    EmbeddedStepperSettings embedded = with_detail(1);
    std::shared_ptr<const EngineWeights>
        detail;             ///< of a network for the fine garment, such as
                            ///< one trained with `train --proxies`; null: none
    EngineSettings engine;  ///< that runs it

    /// For a fine garment on a character: a network for steps of 1/60 s, such as `small60`, is
    /// asked on the proxy in each of them, two iterations follow, and the fine garment has no step
    /// of its own. A proxy of 1,500 vertices suits it. World steps should be multiples of 1/60 s;
    /// others are made without the network.
    static ProxyClothSettings learned(std::shared_ptr<const EngineWeights> weights);

    static EmbeddedStepperSettings with_detail(int iterations) {
        EmbeddedStepperSettings settings;
        settings.detail_iterations = iterations;
        return settings;
    }
};

/// A fine garment that follows a coarse one with a step of its own: the proxy is simulated as
/// make_cloth() does it, and gives the start of that step.
///
///     const auto proxy = std::make_shared<const Garment>(make_proxy(shirt, {1000}));
///     const std::unique_ptr<Stepper> stepper = make_proxy_cloth(shirt, proxy);
///
/// Not for layers that are one garment (merge_garments()): where they lie on each other, the fine
/// mesh is torn.
/// Keeps a reference to `fine`. @throws ArgumentError as EmbeddedStepper does
std::unique_ptr<EmbeddedStepper> make_proxy_cloth(const Garment& fine,
                                                  std::shared_ptr<const Garment> proxy,
                                                  const ProxyClothSettings& settings = {});

}  // namespace cloth
