#include "gnn/model/make_cloth.h"

#include <utility>

#include "gnn/model/network_start.h"

namespace cloth {

std::unique_ptr<ClothStepper> make_cloth(const Garment& garment, const ClothSettings& settings) {
    std::shared_ptr<Predictor> engine;
    if (settings.weights) engine = std::make_shared<Engine>(settings.weights, settings.engine);
    return make_cloth(garment, std::move(engine), settings);
}

std::unique_ptr<ClothStepper> make_cloth(const Garment& garment,
                                         std::shared_ptr<Predictor> predictor,
                                         const ClothStepperSettings& settings) {
    std::shared_ptr<StepStart> start;
    if (predictor) start = std::make_shared<NetworkStart>(garment, std::move(predictor));
    return std::make_unique<ClothStepper>(garment, settings, start);
}

}  // namespace cloth
