#include "gnn/model/learned_cloth.h"

#include <utility>

namespace cloth {

std::unique_ptr<Stepper> make_learned_cloth(const Garment& garment,
                                            std::shared_ptr<const EngineWeights> weights,
                                            const LearnedClothSettings& settings) {
    auto engine = std::make_shared<Engine>(std::move(weights), settings.engine);
    auto learned = std::make_unique<LearnedStepper>(garment, std::move(engine), settings.step);
    GuardSettings guard = settings.guard;
    guard.solver.potential = settings.step.potential;
    return std::make_unique<GuardedStepper>(garment, std::move(learned), guard);
}

}  // namespace cloth
