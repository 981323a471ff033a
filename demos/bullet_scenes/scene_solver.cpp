#include "demos/bullet_scenes/scene_solver.h"

#include "demos/compare/arguments.h"
#include "demos/compare/solver_factory.h"
#include "gnn/model/learned_cloth.h"
#include "gnn/physics/stepper/quasi_newton_stepper.h"

namespace cloth {

namespace {

StepperFactory quasi_newton(int iterations) {
    return [iterations](const Garment& garment) -> std::unique_ptr<Stepper> {
        QuasiNewtonSettings settings;
        settings.iterations = iterations;
        GuardSettings guard;
        guard.solver.iterations = iterations;
        return std::make_unique<GuardedStepper>(
            garment, std::make_unique<QuasiNewtonStepper>(garment, settings), guard);
    };
}

StepperFactory network(const std::string& name, const std::string& folder) {
    const NetworkName wanted(name);
    if (wanted.torch) throw UsageError("solver " + name + ": here networks run in the engine only");
    LearnedClothSettings settings;
    if (!wanted.as_shipped)
        settings.step.refine = whole_number("solver " + name, wanted.refine, 0, 100);
    const auto weights = std::make_shared<const EngineWeights>(
        Weights::load(weights_file(wanted.variant, folder)),
        wanted.bfloat16 ? Precision::bfloat16 : Precision::float32);
    return [weights, settings](const Garment& garment) {
        return make_learned_cloth(garment, weights, settings);
    };
}

}  // namespace

std::unique_ptr<btGnnSoftBodySolver> SceneSolvers::make(const std::string& name) const {
    if (name == "bullet") return nullptr;
    const std::string prefix = "quasi-newton-";
    if (name.rfind(prefix, 0) == 0)
        return std::make_unique<btGnnSoftBodySolver>(
            quasi_newton(whole_number("solver " + name, name.substr(prefix.size()), 1, 1000)));
    return std::make_unique<btGnnSoftBodySolver>(network(name, m_weights));
}

}  // namespace cloth
