#pragma once

#include <memory>

#include "gnn/model/engine.h"
#include "gnn/model/learned_stepper.h"
#include "gnn/physics/stepper/guarded_stepper.h"

namespace cloth {

struct LearnedClothSettings {
    LearnedStepperSettings step;
    GuardSettings guard;
    EngineSettings engine;
};

/// The learned solver as it should be used: the network in the engine, refined, and guarded where
/// one step cannot be trusted.
///
///     const auto weights = std::make_shared<const EngineWeights>(Weights::load(file));
///     btGnnSoftBodySolver solver([&](const Garment& garment) {
///         return make_learned_cloth(garment, weights);
///     });
///
/// Guarded sub-steps minimise the potential of `settings.step`, whatever `settings.guard.solver`
/// holds. Keeps a reference to `garment`. @throws ArgumentError if a setting is out of range
std::unique_ptr<Stepper> make_learned_cloth(const Garment& garment,
                                            std::shared_ptr<const EngineWeights> weights,
                                            const LearnedClothSettings& settings = {});

}  // namespace cloth
