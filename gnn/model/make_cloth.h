#pragma once

#include <memory>

#include "gnn/model/engine.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth {

struct ClothSettings : ClothStepperSettings {
    std::shared_ptr<const EngineWeights> weights;  ///< of a trained network; null: physics alone
    EngineSettings engine;                         ///< that runs the network
    /// Whether steps from a network's prediction are small ones, too, if `step` has them. If not
    /// they are those of StepSettings::whole(): bodies that touch the cloth lose momentum to small
    /// steps as long as a network's.
    bool small_steps_from_network = false;
};

/// The solver of a garment as it should be used: small steps, or whole ones from the network's
/// prediction, which are cut into parts where they cannot be trusted.
///
///     ClothSettings settings;
///     settings.weights = std::make_shared<const EngineWeights>(Weights::load(file));  // optional
///     btGnnSoftBodySolver solver([&](const Garment& garment) {
///         return make_cloth(garment, settings);
///     });
///
/// Keeps a reference to `garment`. @throws ArgumentError if a setting is out of range
std::unique_ptr<ClothStepper> make_cloth(const Garment& garment,
                                         const ClothSettings& settings = {});

/// The same with a network that something else evaluates, such as LibTorch; null: none.
std::unique_ptr<ClothStepper> make_cloth(const Garment& garment,
                                         std::shared_ptr<Predictor> predictor,
                                         ClothStepperSettings settings = {},
                                         bool small_steps_from_network = false);

}  // namespace cloth
