#include <limits>

#include "data/core/errors.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::reference_step_test {

using namespace cloth::test;

namespace {

const double pi = std::acos(-1.0);

class ReferenceStep : public ::testing::TestWithParam<Fabric> {};

Obstacle sphere(const Vec3& centre, double radius) {
    Obstacle obstacle;
    obstacle.shape = ObstacleShape::sphere;
    obstacle.radius = radius;
    obstacle.pose0.translation() = obstacle.pose1.translation() = centre;
    return obstacle;
}

/// A plane through the origin that falls by `angle` towards +x.
Obstacle incline(double angle, double friction) {
    Obstacle obstacle;
    obstacle.shape = ObstacleShape::plane;
    obstacle.pose0.rotate(Eigen::AngleAxisd(-angle, Vec3::UnitZ()));
    obstacle.pose1 = obstacle.pose0;
    obstacle.friction = friction;
    return obstacle;
}

/// How far (m) a sheet that lies on an incline has slid down after `steps` of `dt`.
double slide(double angle, double friction, const Fabric& fabric, int steps, double dt) {
    TriMesh mesh = sheet(5, 0.2);
    const Vec3 down(std::cos(angle), -std::sin(angle), 0),
        normal(std::sin(angle), std::cos(angle), 0);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        const Vec3 flat = mesh.vertices.row(i);
        mesh.vertices.row(i) =
            (flat.x() * down + flat.z() * Vec3::UnitZ() + 3.99e-3 * normal).transpose();
    }
    const Garment garment("sheet", mesh, fabric);
    ClothStepper stepper(garment, ClothStepperSettings::reference());
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    boundary.obstacles.push_back(incline(angle, friction));
    for (int k = 0; k < steps; ++k) {
        const StepReport report = stepper.step(boundary, dt, state);
        EXPECT_TRUE(report.finite);
        EXPECT_LT(report.residual.value(), 1e-4);
        EXPECT_EQ(report.max_penetration, 0.0);
    }
    return ((state.x - mesh.vertices) * down).mean();
}

}  // namespace

TEST_P(ReferenceStep, FreeFallEqualsTheClosedForm) {
    const Garment garment("sheet", sheet(6, 0.3), GetParam());
    ClothStepper stepper(garment, ClothStepperSettings::reference());
    ClothState state = ClothState::at_rest(garment);
    const Points start = state.x;
    const Eigen::RowVector3d v(0.3, 1.0, -0.2), g(0, -9.81, 0);
    state.v.rowwise() = v;
    const double dt = 1.0 / 30.0;
    for (int n = 1; n <= 10; ++n) {
        const StepReport report = stepper.step({}, dt, state);
        EXPECT_TRUE(report.converged);
        // Backward Euler: v_n = v + n dt g, x_n = x + n dt v + n (n + 1) / 2 dt^2 g.
        const Eigen::RowVector3d fallen = n * dt * v + 0.5 * n * (n + 1) * dt * dt * g;
        EXPECT_LT((state.x - start).rowwise().operator-(fallen).cwiseAbs().maxCoeff(), 1e-5);
        EXPECT_NEAR(state.time, n * dt, 1e-12);
    }
}

TEST_P(ReferenceStep, HangingSheetConvergesInFewIterationsAndKeepsItsPins) {
    const Garment garment("sheet", sheet(12, 0.5), GetParam(), {0, 11});
    ClothStepper stepper(garment, ClothStepperSettings::reference());
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    boundary.pin_targets.resize(2, 3);
    boundary.pin_targets << state.x.row(0), state.x.row(11);
    int iterations = 0;
    for (int k = 0; k < 25; ++k) {
        const StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
        EXPECT_TRUE(report.converged) << "step " << k << ", residual " << report.residual.value();
        EXPECT_LE(report.residual.value(), 1e-4);
        EXPECT_LT(report.iterations, 40) << "step " << k;
        iterations += report.iterations;
        EXPECT_EQ(state.x.row(0), boundary.pin_targets.row(0));
        EXPECT_EQ(state.x.row(11), boundary.pin_targets.row(1));
    }
    EXPECT_LT(iterations, 25 * 20);
    EXPECT_LT(state.x.col(1).minCoeff(), -0.3) << "it should have swung down";
}

TEST_P(ReferenceStep, AtEquilibriumThePinsCarryTheWeight) {
    const Garment garment("sheet", sheet(7, 0.3), GetParam(), {0, 1, 2, 3, 4, 5, 6});
    NewtonSettings newton;
    newton.tolerance = 1e-7;
    ClothStepper stepper(garment, ClothStepperSettings::reference(newton));
    ClothState state = ClothState::at_rest(garment);
    for (Eigen::Index i = 0; i < state.x.rows(); ++i)  // hang down from z = 0
        state.x.row(i) << state.x(i, 0), -state.x(i, 2), 0.0;
    Boundary boundary;
    boundary.pin_targets = state.x.topRows(7);
    for (int k = 0; k < 60; ++k) stepper.step(boundary, 0.2, state);
    EXPECT_LT(state.v.norm(), 1e-5);
    const Garment unpinned = garment.with_pins({});
    IncrementalPotential forces(unpinned);
    Points gradient;
    forces.begin_step(state, boundary, {}, 0.2);
    forces.elastic_gradient(state.x, gradient);
    EXPECT_NEAR(gradient.topRows(7).col(1).sum(),
                9.81 * (garment.masses().sum() - garment.masses().head(7).sum()),
                1e-3 * 9.81 * garment.masses().sum());
}

TEST_P(ReferenceStep, ASheetDroppedOnASphereStaysOutside) {
    const Garment garment("sheet", sheet(14, 0.5), GetParam());
    ClothStepper stepper(garment, ClothStepperSettings::reference());
    ClothState state = ClothState::at_rest(garment);
    state.x.rowwise() -= Eigen::RowVector3d(0.27, 0, 0.23);
    Boundary boundary;
    boundary.obstacles.push_back(sphere(Vec3(0, -0.18, 0), 0.15));
    int touching = 0, converged = 0;
    for (int k = 0; k < 15; ++k) {
        const StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
        ASSERT_TRUE(report.finite);
        converged += report.converged;
        EXPECT_EQ(report.max_penetration, 0.0) << "step " << k;
        const VectorX distance =
            (state.x.rowwise() - Eigen::RowVector3d(0, -0.18, 0)).rowwise().norm();
        EXPECT_GE(distance.minCoeff(), 0.15);
        touching += distance.minCoeff() < 0.15 + 4e-3;
    }
    EXPECT_GT(touching, 4);
    // Stiff cloth that buckles into its first folds may need more than 60 iterations.
    EXPECT_GE(converged, 6);
}

TEST_P(ReferenceStep, AFastSpherePushesTheSheetAhead) {
    const Garment garment("sheet", sheet(10, 0.4), GetParam());
    ClothStepperSettings settings = ClothStepperSettings::reference();
    settings.step.contact_updates = 1;
    ClothStepper stepper(garment, settings);
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    boundary.obstacles.push_back(sphere(Vec3(0.2, -0.16, 0.2), 0.15));
    for (int k = 0; k < 6; ++k) {  // 3 cm per step, seven contact distances
        boundary.obstacles[0].pose0 = boundary.obstacles[0].pose1;
        boundary.obstacles[0].pose1.translation().y() += 0.03;
        const StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
        ASSERT_TRUE(report.finite);
        EXPECT_LT(report.max_penetration, 1e-4);
    }
    EXPECT_GT(state.x.col(1).maxCoeff(), 0.15);
}

TEST_P(ReferenceStep, HoldsBelowTheFrictionAngleAndSlidesAbove) {
    const double friction = 0.5, dt = 1.0 / 60.0;  // friction angle 26.6 degrees
    const int steps = 20;
    // Below it the sheet gives by s r / sqrt(1 - r^2), r = tan(angle) / mu, and stays there. The
    // factor: it comes to rest beyond, by as much as it was when it first had no speed.
    const double below = 20.0 * pi / 180.0, r = std::tan(below) / friction;
    const double give = PotentialSettings().friction_slip_speed * dt * r / std::sqrt(1.0 - r * r);
    EXPECT_LT(slide(below, friction, GetParam(), steps, dt), 2.0 * give);
    // Above it, backward Euler of the Coulomb acceleration g (sin - mu cos).
    const double above = 35.0 * pi / 180.0;
    const double a = 9.81 * (std::sin(above) - friction * std::cos(above));
    const double expected = 0.5 * a * dt * dt * steps * (steps + 1);
    EXPECT_NEAR(slide(above, friction, GetParam(), steps, dt), expected, 0.03 * expected);
}

TEST_P(ReferenceStep, ClothThatFrictionHoldsDoesNotCreepAtAnyRate) {
    const double angle = 20.0 * pi / 180.0;
    for (const int rate : {30, 240}) {
        const double dt = 1.0 / rate;
        const double early = slide(angle, 0.5, GetParam(), rate / 2, dt);
        const double late = slide(angle, 0.5, GetParam(), 2 * rate, dt);
        EXPECT_GT(early, 0.0);
        EXPECT_NEAR(late, early, 2e-5) << "1.5 s later, at " << rate << " Hz";
    }
}

TEST_P(ReferenceStep, AFailedStepLeavesTheStateUntouched) {
    const Garment garment("sheet", sheet(4, 0.2), GetParam(), {0});
    ClothStepper stepper(garment, ClothStepperSettings::reference());
    Boundary good;
    good.pin_targets = garment.rest().vertices.topRows(1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto fails = [&](const Boundary& boundary, double dt) {
        ClothState state = ClothState::at_rest(garment);
        const StepReport report = stepper.step(boundary, dt, state);
        EXPECT_EQ(state.x, garment.rest().vertices);
        EXPECT_EQ(state.v.norm(), 0.0);
        EXPECT_EQ(state.time, 0.0);
        return !report.finite;
    };
    Boundary bad = good;
    bad.gravity.x() = nan;
    EXPECT_TRUE(fails(bad, 0.01));
    bad = good;
    bad.pin_targets.resize(0, 3);
    EXPECT_TRUE(fails(bad, 0.01));
    EXPECT_TRUE(fails(good, nan));
    EXPECT_TRUE(fails(good, 0.0));
    ClothState state = ClothState::at_rest(garment);
    EXPECT_TRUE(stepper.step(good, 0.01, state).finite);
}

TEST_P(ReferenceStep, EqualInputsGiveEqualBits) {
    const Garment garment("sheet", sheet(8, 0.3), GetParam());
    Boundary boundary;
    boundary.obstacles.push_back(sphere(Vec3(0.15, -0.11, 0.15), 0.1));
    ClothState first = ClothState::at_rest(garment), second = first;
    ClothStepper a(garment, ClothStepperSettings::reference());
    ClothStepper b(garment, ClothStepperSettings::reference());
    for (int k = 0; k < 5; ++k) {
        a.step(boundary, 1.0 / 30.0, first);
        b.step(boundary, 1.0 / 30.0, second);
    }
    EXPECT_EQ(first.x, second.x);
    EXPECT_EQ(first.v, second.v);
}

TEST_P(ReferenceStep, SettingsOutOfRangeAreRefused) {
    const Garment garment("sheet", sheet(4, 0.2), GetParam());
    const auto expect_refused = [&](auto change) {
        ClothStepperSettings settings = ClothStepperSettings::reference();
        change(settings.step);
        EXPECT_THROW(ClothStepper(garment, settings), ArgumentError);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_refused([](StepSettings& step) { step.contact_updates = -1; });
    expect_refused([](StepSettings& step) { step.contact_updates = 11; });
    expect_refused([](StepSettings& step) { step.safety_distance = -1e-6; });
    expect_refused([=](StepSettings& step) { step.safety_distance = nan; });
    expect_refused([](StepSettings& step) { step.potential.contact_distance = -1.0; });
    expect_refused([](StepSettings& step) { step.newton.max_iterations = -5; });
    expect_refused([](StepSettings& step) { step.quasi_newton.iterations = -5; });
}

INSTANTIATE_TEST_SUITE_P(Fabrics, ReferenceStep,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace cloth::reference_step_test
