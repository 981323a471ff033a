#include "gnn/model/make_cloth.h"

#include <utility>

#include "gnn/model/network_start.h"

namespace cloth {

std::unique_ptr<ClothStepper> make_cloth(const Garment& garment, const ClothSettings& settings) {
    std::shared_ptr<Predictor> engine;
    if (settings.weights) engine = std::make_shared<Engine>(settings.weights, settings.engine);
    return make_cloth(garment, std::move(engine), settings, settings.small_steps_from_network);
}

std::unique_ptr<ClothStepper> make_cloth(const Garment& garment,
                                         std::shared_ptr<Predictor> predictor,
                                         ClothStepperSettings settings,
                                         bool small_steps_from_network) {
    if (predictor && settings.step.small_step_rate > 0.0 && !small_steps_from_network) {
        settings.step.small_step_rate = 0.0;
        settings.step.quasi_newton = StepSettings::whole().quasi_newton;
    }
    std::shared_ptr<StepStart> start;
    if (predictor) start = std::make_shared<NetworkStart>(garment, std::move(predictor));
    return std::make_unique<ClothStepper>(garment, settings, start);
}

}  // namespace cloth
