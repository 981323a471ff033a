#include "demos/bullet_scenes/scene_solver.h"

#include <algorithm>
#include <optional>

#include "demos/compare/arguments.h"
#include "demos/compare/solver_factory.h"
#include "gnn/model/make_cloth.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"

namespace cloth {

namespace {

StepperFactory quasi_newton(int iterations) {
    ClothSettings settings;
    settings.step = StepSettings::whole(IterationLimits::exactly(iterations));
    settings.guard.iterations.iterations = iterations;
    return [settings](const Garment& garment) { return make_cloth(garment, settings); };
}

StepperFactory small_steps(const StepSettings& step) {
    ClothSettings settings;
    settings.step = step;
    return [settings](const Garment& garment) { return make_cloth(garment, settings); };
}

StepperFactory xpbd(int substeps) {
    XpbdSettings settings;
    settings.substeps = substeps;
    return [settings](const Garment& garment) {
        return std::make_unique<XpbdStepper>(garment, settings);
    };
}

/// The K of a name that is PREFIX and K; none if it is not.
std::optional<int> number_after(const std::string& name, const std::string& prefix) {
    if (name.rfind(prefix, 0) != 0) return std::nullopt;
    return whole_number("solver " + name, name.substr(prefix.size()), 1, 1000);
}

StepperFactory network(const std::string& name, const std::string& folder) {
    const NetworkName wanted(name);
    if (wanted.torch) throw UsageError("solver " + name + ": here networks run in the engine only");
    const std::vector<std::string> networks = networks_in(folder);
    if (std::find(networks.begin(), networks.end(), wanted.variant) == networks.end())
        throw UsageError("solver " + name +
                         ": is unknown; choose bullet, default, quasi-newton-K, "
                         "quasi-newton-KsR[-cgN], xpbd-N, or NAME[+K] of a network (" +
                         join_list(networks, ", ") + ")");
    ClothSettings settings;
    const std::string prefix = wanted.variant + "+";
    const auto small = small_steps_named(prefix + wanted.refine, prefix);
    settings.small_steps_from_network = small.has_value();
    if (small)
        settings.step = *small;
    else if (!wanted.as_shipped)
        settings.step = StepSettings::whole(
            IterationLimits::exactly(whole_number("solver " + name, wanted.refine, 0, 100)));
    settings.weights = std::make_shared<const EngineWeights>(
        Weights::load(weights_file(wanted.variant, folder)),
        wanted.bfloat16 ? Precision::bfloat16 : Precision::float32);
    return [settings](const Garment& garment) { return make_cloth(garment, settings); };
}

}  // namespace

btGnnSolverSettings defaults_of(const SceneRecipe& recipe) {
    btGnnSolverSettings settings;
    if (!isSmallScene(recipe)) return settings;
    settings.fabric = Fabric::soft_cotton();
    settings.friction = btGnnFriction::coulomb;
    return settings;
}

std::unique_ptr<btGnnSoftBodySolver> SceneSolvers::make(const std::string& name,
                                                        const btGnnSolverSettings& settings) const {
    if (name == "bullet") return nullptr;
    StepperFactory factory;
    if (name == "default")
        factory = small_steps({});
    else if (const auto small = small_steps_named(name))
        factory = small_steps(*small);
    else if (const auto iterations = number_after(name, "quasi-newton-"))
        factory = quasi_newton(*iterations);
    else if (const auto substeps = number_after(name, "xpbd-"))
        factory = xpbd(*substeps);
    else
        factory = network(name, m_weights);
    return std::make_unique<btGnnSoftBodySolver>(factory, settings);
}

}  // namespace cloth
