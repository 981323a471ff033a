#include "gnn/physics/energy/time_integration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gnn/physics/stepper/cloth_stepper.h"
#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::time_integration_test {

using cloth::test::sheet_on_sphere;
using cloth::test::SolverScene;
using cloth::test::swinging_sheet;

namespace {

constexpr double omega = 3.0;  // 1/s

/// One step of x'' = -omega^2 x for a unit mass, by the minimum of inertia and spring.
void swing(TimeIntegration& time, ClothState& state, double dt) {
    const InertialStep* step = time.begin_step(state, {}, 0.0, dt);
    const double weight = (step ? step->weight[0] : 1.0) / (dt * dt);
    const Points target = step ? step->target : Points(state.x + dt * state.v);
    const Points x = weight / (weight + omega * omega) * target;
    const Points v = (x - state.x) / dt;
    time.end_step(state, x, v, dt);
    state.x = x;
    state.v = v;
}

ClothState at(double x, double v) {
    ClothState state;
    state.x = Points::Constant(1, 3, x);
    state.v = Points::Constant(1, 3, v);
    return state;
}

double error_after_one_second(Integrator kind, int steps) {
    TimeIntegration time(kind);
    ClothState state = at(1.0, 0.0);
    for (int k = 0; k < steps; ++k) swing(time, state, 1.0 / steps);
    return std::abs(state.x(0, 0) - std::cos(omega));
}

/// Root mean square distance (m) of a sheet after half a second of swing to the fine solution.
double swing_error(Integrator kind, const Points& fine) {
    SolverScene scene = swinging_sheet(8);
    ClothStepperSettings settings = ClothStepperSettings::plain(IterationLimits::until(1e-4, 100));
    settings.step.potential.integrator = kind;
    ClothStepper stepper(scene.garment, settings);
    for (int k = 0; k < 15; ++k)
        EXPECT_TRUE(stepper.step(scene.boundary, 1.0 / 30.0, scene.state).finite);
    return std::sqrt((scene.state.x - fine).rowwise().squaredNorm().mean());
}

}  // namespace

TEST(TimeIntegration, BackwardEulerIsOfFirstAndBdf2OfSecondOrder) {
    for (const auto& [kind, order] :
         {std::pair(Integrator::backward_euler, 1.0), std::pair(Integrator::bdf2, 2.0)}) {
        const double coarse = error_after_one_second(kind, 200);
        const double fine = error_after_one_second(kind, 400);
        EXPECT_NEAR(std::log2(coarse / fine), order, 0.15);
    }
    EXPECT_LT(error_after_one_second(Integrator::bdf2, 30),
              0.5 * error_after_one_second(Integrator::backward_euler, 30));
}

TEST(TimeIntegration, StartsAndStartsAgainWithBackwardEuler) {
    const double dt = 0.1;
    TimeIntegration time(Integrator::bdf2);
    ClothState state = at(1.0, 0.5);
    EXPECT_EQ(time.begin_step(state, {}, 0.0, dt), nullptr) << "no history yet";
    swing(time, state, dt);
    ASSERT_NE(time.begin_step(state, {}, 0.0, dt), nullptr);
    EXPECT_EQ(time.begin_step(state, {}, 0.0, 0.5 * dt), nullptr) << "another time step";
    ClothState moved = state;
    moved.x(0, 1) += 1e-12;
    EXPECT_EQ(time.begin_step(moved, {}, 0.0, dt), nullptr) << "moved from outside";
    TimeIntegration plain(Integrator::backward_euler);
    swing(plain, state, dt);
    EXPECT_EQ(plain.begin_step(state, {}, 0.0, dt), nullptr);
}

TEST(TimeIntegration, VerticesInContactTakeBackwardEuler) {
    const double dt = 0.1;
    TimeIntegration time(Integrator::bdf2);
    ClothState state = at(1.0, 0.5);
    swing(time, state, dt);
    const SurfaceContacts near = cloth::test::plane_contacts(
        state.x, state.x.row(0).transpose() - 0.003 * Vec3::UnitY(), Vec3::UnitY());
    const InertialStep* step = time.begin_step(state, near, 0.004, dt);
    ASSERT_NE(step, nullptr);
    EXPECT_EQ(step->weight[0], 1.0);
    EXPECT_EQ(step->target.row(0), (state.x + dt * state.v).row(0));
    step = time.begin_step(state, near, 0.002, dt);
    EXPECT_EQ(step->weight[0], 2.25) << "near, but not in contact";
}

TEST(TimeIntegration, FreeFallIsExactAfterTheFirstStep) {
    SolverScene scene = sheet_on_sphere(8);
    scene.boundary.obstacles.clear();
    const Points start = scene.state.x, v0 = scene.state.v;
    ClothStepperSettings settings = ClothStepperSettings::plain();
    settings.step.potential.integrator = Integrator::bdf2;
    ClothStepper stepper(scene.garment, settings);
    const double dt = 1.0 / 30.0;
    const auto fallen = [&](int step) {
        EXPECT_TRUE(stepper.step(scene.boundary, dt, scene.state).finite);
        return (scene.state.x - start - step * dt * v0).col(1).mean();
    };
    // second differences of the path, which backward Euler's first step shifts, are those of g
    std::vector<double> path = {0.0};
    for (int step = 1; step <= 40; ++step) path.push_back(fallen(step));
    for (size_t k = 30; k + 1 < path.size(); ++k)
        EXPECT_NEAR((path[k + 1] - 2 * path[k] + path[k - 1]) / (dt * dt), -9.81, 1e-6);
    EXPECT_NEAR(path[40], -0.5 * 9.81 * std::pow(40 * dt, 2), 0.02 * -path[40]);
}

TEST(TimeIntegration, Bdf2BringsASwingingSheetNearerToTheFineSolution) {
    SolverScene scene = swinging_sheet(8);
    ClothStepperSettings settings = ClothStepperSettings::plain(IterationLimits::until(1e-4, 100));
    ClothStepper stepper(scene.garment, settings);
    for (int k = 0; k < 15 * 32; ++k) stepper.step(scene.boundary, 1.0 / 960.0, scene.state);
    EXPECT_LT(swing_error(Integrator::bdf2, scene.state.x),
              0.7 * swing_error(Integrator::backward_euler, scene.state.x));
}

TEST(TimeIntegration, Bdf2DoesNotThrowClothBackFromASphere) {
    SolverScene scene = sheet_on_sphere(12);
    scene.state.v.col(1).setConstant(-3.0);
    ClothStepperSettings settings = ClothStepperSettings::plain(IterationLimits::exactly(30));
    settings.step.potential.integrator = Integrator::bdf2;
    ClothStepper stepper(scene.garment, settings);
    const double top = scene.state.x.col(1).maxCoeff();
    for (int k = 0; k < 20; ++k) {
        ASSERT_TRUE(stepper.step(scene.boundary, 1.0 / 30.0, scene.state).finite);
        EXPECT_LT(scene.state.x.col(1).maxCoeff(), top + 0.01);
    }
}

}  // namespace cloth::time_integration_test
