#include "data/authoring/sheet.h"
#include "gnn/graph/cloth_graph.h"
#include "gnn/graph/features.h"
#include "gnn/model/engine.h"
#include "gnn/model/model_config.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/newton.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

const Garment& sheet() {
    static const Garment garment("sheet", make_sheet(1.0, 1.0, 20), Fabric::soft_cotton(), {});
    return garment;
}

TEST(SettingsRanges, Potential) {
    using S = PotentialSettings;
    const std::string name = "PotentialSettings.";
    const auto use = [](const S& settings) { IncrementalPotential(sheet(), settings); };
    expect_range(name + "contact_distance", &S::contact_distance, 1e-3, 1e-2, use);
    expect_range(name + "contact_weight", &S::contact_weight, 1e3, 1e6, use);
    expect_range(name + "ridge_distance", &S::ridge_distance, 0.0, S().contact_distance, use);
    expect_range(name + "friction_scale", &S::friction_scale, 0.0, 10.0, use);
    expect_range(name + "friction_distance", &S::friction_distance, 0.0, 0.1, use);
    expect_range(name + "friction_slip_speed", &S::friction_slip_speed, 1e-5, 1.0, use);
    expect_range(name + "goal_stiffness", &S::goal_stiffness, 0.1, 1000.0, use);
    expect_range(name + "friction_limit", &S::friction_limit, 0.0, 100.0, use);
    expect_range(name + "pinch_pressure", &S::pinch_pressure, 0.0, 1e5, use);
}

TEST(SettingsRanges, Newton) {
    using S = NewtonSettings;
    const auto use = [](const S& settings) { Newton(sheet(), settings); };
    expect_range("NewtonSettings.max_iterations", &S::max_iterations, 0, 10000, use);
    expect_range("NewtonSettings.tolerance", &S::tolerance, 0.0, 1.0, use);
    expect_range("NewtonSettings.exact_below", &S::exact_below, 0.0, 1.0, use);
}

TEST(SettingsRanges, QuasiNewton) {
    using S = QuasiNewtonSettings;
    const std::string name = "QuasiNewtonSettings.";
    const auto use = [](const S& settings) { QuasiNewton(sheet(), settings); };
    expect_range(name + "iterations", &S::iterations, 0, 10000, use);
    expect_range(name + "tolerance", &S::tolerance, 0.0, 1e6, use);
    expect_range(name + "least_gain", &S::least_gain, 0.0, 1.0, use);
    expect_range(name + "least_iterations", &S::least_iterations, 0, 10000, use);
    expect_range(name + "history", &S::history, 0, 50, use);
    expect_range(name + "contact_cg_iterations", &S::contact_cg_iterations, 0, 50, use);
    expect_range(name + "hessian_cg_iterations", &S::hessian_cg_iterations, 0, 200, use);
}

TEST(SettingsRanges, Step) {
    using S = StepSettings;
    const auto use = [](const S& settings) { StepSolver(sheet(), settings); };
    expect_range("StepSettings.contact_updates", &S::contact_updates, 0, 10, use);
    expect_range("StepSettings.safety_distance", &S::safety_distance, 0.0, 1e-3, use);
}

TEST(SettingsRanges, Guard) {
    using S = GuardSettings;
    const auto use = [](const S& guard) {
        ClothStepperSettings settings;
        settings.guard = guard;
        ClothStepper(sheet(), settings);
    };
    const std::string name = "GuardSettings.";
    expect_range(name + "max_motion", &S::max_motion, 0.01, 1.0, use);
    expect_range(name + "max_entry", &S::max_entry, 1e-3, 0.1, use);
    expect_range(name + "fine_motion", &S::fine_motion, 0.01, 1.0, use);
    expect_range(name + "watch_motion", &S::watch_motion, 5e-3, 1.0, use);
    expect_range(name + "tunnelling_motion", &S::tunnelling_motion, 1e-3, 1.0, use);
    expect_range(name + "max_substeps", &S::max_substeps, 1, 64, use);
    expect_range("ClothStepperSettings.substeps", &ClothStepperSettings::substeps, 1, 64,
                 [](const ClothStepperSettings& settings) { ClothStepper(sheet(), settings); });
}

TEST(SettingsRanges, Xpbd) {
    using S = XpbdSettings;
    const auto use = [](const S& settings) { XpbdStepper(sheet(), settings); };
    expect_range("XpbdSettings.substeps", &S::substeps, 1, 1000, use);
    expect_range("XpbdSettings.iterations", &S::iterations, 1, 100, use);
    expect_range("XpbdSettings.relaxation", &S::relaxation, 1.0, 1.3, use);
    expect_range("XpbdSettings.damping", &S::damping, 0.0, 10.0, use);
    expect_range("XpbdSettings.bending_angle", &S::bending_angle, 0.01, 1.5, use);
    expect_range("XpbdSettings.contact_distance", &S::contact_distance, 5e-4, 1e-2, use);
}

TEST(SettingsRanges, GraphAndFeatures) {
    const auto build = [](const GraphSettings& settings) { build_cloth_graph(sheet(), settings); };
    expect_range("GraphSettings.steps", &GraphSettings::steps, 1, 64, build);
    expect_range("GraphSettings.sampled_edges", &GraphSettings::sampled_edges, 0, 32, build);
    const ClothGraph graph = build_cloth_graph(sheet(), {});
    expect_range(
        "FeatureSettings.world_radius", &FeatureSettings::world_radius, 1e-3, 1.0,
        [&](const FeatureSettings& settings) { FeatureBuilder(sheet(), graph, settings); });
}

TEST(SettingsRanges, ModelConfig) {
    using S = ModelConfig;
    const auto use = [](const S& config) { config.check(); };
    expect_range("ModelConfig.steps", &S::steps, 1, 64, use);
    expect_range("ModelConfig.width", &S::width, 4, 512, use);
    expect_range("ModelConfig.hidden_layers", &S::hidden_layers, 1, 4, use);
    expect_range("ModelConfig.sampled_edges", &S::sampled_edges, 0, 32, use);
    expect_range("ModelConfig.message_scale", &S::message_scale, 1e-3, 10.0, use);
    expect_range("ModelConfig.dt", &S::dt, 1e-4, 1.0, use);
    expect_range("ModelConfig.features.world_radius", 1e-3, 1.0, [](double value) {
        ModelConfig config;
        config.features.world_radius = value;
        config.check();
    });
}

TEST(SettingsRanges, Engine) {
    const auto use = [](const EngineSettings& settings) {
        Engine(std::shared_ptr<const EngineWeights>(), settings);
    };
    expect_range("EngineSettings.threads", &EngineSettings::threads, 0, 1024, use);
}

}  // namespace
}  // namespace cloth::test
