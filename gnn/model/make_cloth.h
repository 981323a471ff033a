#pragma once

#include <memory>

#include "gnn/model/engine.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth {

struct ClothSettings : ClothStepperSettings {
    std::shared_ptr<const EngineWeights> weights;  ///< of a trained network; null: physics alone
    EngineSettings engine;                         ///< that runs the network
};

/// The solver of a garment as it should be used: quasi-Newton iterations with error control from
/// the network's prediction, or from the projected extrapolation without weights, and steps cut
/// into parts where one cannot be trusted.
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

/// The same with a network that something else evaluates, such as LibTorch; null: none. Neither
/// `settings.weights` nor `settings.engine` count.
std::unique_ptr<ClothStepper> make_cloth(const Garment& garment,
                                         std::shared_ptr<Predictor> predictor,
                                         const ClothStepperSettings& settings = {});

}  // namespace cloth
