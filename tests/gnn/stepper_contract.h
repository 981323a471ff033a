#pragma once

#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <string>

#include "collision/proximity/metrics.h"
#include "collision/proximity/proximity.h"
#include "gnn/stepper.h"
#include "tests/gnn/physics/solver/solver_scenes.h"
#include "tests/sanitized.h"

/// What every Stepper promises, as tests that any test program can instantiate for its steppers:
///
///     INSTANTIATE_TEST_SUITE_P(Physics, StepperContract, ::testing::ValuesIn(cases), case_name);
///
/// A stepper that does not promise one of the optional things names it in `exceptions` with the
/// reason, which the skipped test then says. What is not in `Promise` is promised by all: pins on
/// targets, finite output, failed steps that change nothing, equal bits.
namespace cloth::test {

enum class Promise {
    free_fall,  ///< a free garment falls as backward Euler's closed form says
    rest,       ///< without gravity, a flat garment at rest does not move
    translation_equivariance,
    yaw_equivariance,        ///< rotation about gravity's axis
    permutation_invariance,  ///< the order of vertices and faces does not matter
    any_time_step,
    stays_outside,  ///< no free vertex ends inside an obstacle by more than 1 mm
};

struct StepperCase {
    std::string name;  ///< letters and digits
    std::function<std::unique_ptr<Stepper>(const Garment&)> make;
    double tolerance = 1e-7;  ///< of positions where exact arithmetic would give equality (m)
    std::map<Promise, std::string> exceptions;  ///< not promised, and why
};

inline std::string case_name(const ::testing::TestParamInfo<StepperCase>& info) {
    return info.param.name;
}

inline void PrintTo(const StepperCase& parameter, std::ostream* out) {
    *out << parameter.name;
}

class StepperContract : public ::testing::TestWithParam<StepperCase> {
 protected:
    static std::unique_ptr<Stepper> make(const Garment& garment) {
        return GetParam().make(garment);
    }

    static double dt(const Stepper& stepper) {
        return stepper.fixed_dt() > 0.0 ? stepper.fixed_dt() : 1.0 / 30.0;
    }

    /// `steps` steps of a fresh stepper from the scene's state.
    static ClothState after(const SolverScene& scene, int steps) {
        const std::unique_ptr<Stepper> stepper = make(scene.garment);
        ClothState state = scene.state;
        for (int k = 0; k < steps; ++k)
            EXPECT_TRUE(stepper->step(scene.boundary, dt(*stepper), state).finite) << "step " << k;
        return state;
    }

    static double max_distance(const Points& a, const Points& b) {
        return (a - b).rowwise().norm().maxCoeff();
    }

    static double tolerance() { return GetParam().tolerance; }
};

#define CLOTH_SKIP_UNLESS_PROMISED(promise)                     \
    if (const auto found = GetParam().exceptions.find(promise); \
        found != GetParam().exceptions.end())                   \
    GTEST_SKIP() << GetParam().name << " does not promise this: " << found->second

inline bool same_bits(const Points& a, const Points& b) {
    return a.rows() == b.rows() &&
           std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<size_t>(a.size())) == 0;
}

inline bool same_bits(const ClothState& a, const ClothState& b) {
    return same_bits(a.x, b.x) && same_bits(a.v, b.v) &&
           std::memcmp(&a.time, &b.time, sizeof(double)) == 0;
}

/// The scene in another place and, about the vertical axis, in another direction.
inline SolverScene moved(SolverScene scene, const Pose& pose) {
    const auto move_points = [&](Points& points) {
        if (points.rows() == 0) return;
        points = ((points * pose.linear().transpose()).rowwise() + pose.translation().transpose())
                     .eval();
    };
    move_points(scene.state.x);
    scene.state.v = (scene.state.v * pose.linear().transpose()).eval();
    move_points(scene.boundary.pin_targets);
    for (Obstacle& obstacle : scene.boundary.obstacles) {
        move_points(obstacle.x0);
        move_points(obstacle.x1);
        obstacle.pose0 = pose * obstacle.pose0;
        obstacle.pose1 = pose * obstacle.pose1;
    }
    return scene;
}

/// A swinging sheet with a sphere in its way: pins, contact and friction in one scene.
inline SolverScene busy_scene() {
    SolverScene scene = swinging_sheet(9);
    scene.boundary.obstacles.push_back(sphere(Vec3(0.25, -0.11, 0.3), 0.1));
    return scene;
}

/// A scene whose vertex i is the other's vertex order[i]; its faces stand in reverse order.
inline SolverScene renumbered(const SolverScene& scene, const std::vector<int>& order) {
    std::vector<int> place(order.size());
    for (size_t i = 0; i < order.size(); ++i) place[static_cast<size_t>(order[i])] = int(i);
    TriMesh rest{rows_of(scene.garment.rest().vertices, order), scene.garment.rest().faces};
    for (Eigen::Index k = 0; k < rest.faces.size(); ++k)
        rest.faces.data()[k] = place[static_cast<size_t>(rest.faces.data()[k])];
    rest.faces = rest.faces.colwise().reverse().eval();
    std::vector<int> pins;
    for (const int pin : scene.garment.pins()) pins.push_back(place[static_cast<size_t>(pin)]);
    Garment garment("renumbered", std::move(rest), scene.garment.fabric(), pins);
    ClothState state{rows_of(scene.state.x, order), rows_of(scene.state.v, order), 0.0};
    Boundary boundary = scene.boundary;
    boundary.pin_targets = rows_of(state.x, garment.pins());
    return {std::move(garment), std::move(state), std::move(boundary)};
}

TEST_P(StepperContract, FreeFallEqualsTheClosedForm) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::free_fall);
    const Garment garment("sheet", sheet(8, 0.5), Fabric::soft_cotton());
    const std::unique_ptr<Stepper> stepper = make(garment);
    const double h = dt(*stepper);
    ClothState state = ClothState::at_rest(garment);
    const Vec3 v0(0.5, 1.0, -0.25);
    state.v.rowwise() = v0.transpose();
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    const int steps = 10;
    for (int k = 0; k < steps; ++k) ASSERT_TRUE(stepper->step(boundary, h, state).finite);
    // Backward Euler: v_k = v0 + k h g, x_n = x0 + h (v_1 + ... + v_n).
    const Vec3 travel = steps * h * v0 + 0.5 * steps * (steps + 1) * h * h * boundary.gravity;
    const Points expected = garment.rest().vertices.rowwise() + travel.transpose();
    EXPECT_LE(max_distance(state.x, expected), tolerance());
    EXPECT_NEAR(state.time, steps * h, 1e-12);
}

TEST_P(StepperContract, RestStaysAtRest) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::rest);
    for (const std::vector<int>& pins : {std::vector<int>{}, std::vector<int>{0, 7}}) {
        const Garment garment("sheet", sheet(8, 0.5), Fabric::soft_cotton(), pins);
        Boundary boundary;
        boundary.gravity.setZero();
        boundary.pin_targets = rows_of(garment.rest().vertices, garment.pins());
        const ClothState state = after({garment, ClothState::at_rest(garment), boundary}, 10);
        EXPECT_LE(max_distance(state.x, garment.rest().vertices), tolerance());
    }
}

TEST_P(StepperContract, PinsLandOnTheirTargets) {
    SolverScene scene = busy_scene();
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    for (int k = 0; k < 5; ++k) {
        scene.boundary.pin_targets.rowwise() += Eigen::RowVector3d(0.01, 0.004 * k, -0.02);
        const Points before = scene.state.x;
        ASSERT_TRUE(stepper->step(scene.boundary, dt(*stepper), scene.state).finite);
        EXPECT_TRUE(
            same_bits(rows_of(scene.state.x, scene.garment.pins()), scene.boundary.pin_targets));
        const Points velocity = (scene.state.x - before) / dt(*stepper);
        EXPECT_LE(max_distance(scene.state.v, velocity), 1e-9) << "velocity is the motion over dt";
    }
}

TEST_P(StepperContract, ATranslatedSceneMovesAlike) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::translation_equivariance);
    Pose pose = Pose::Identity();
    pose.translation() = Vec3(3.0, -2.0, 1.0);
    const SolverScene scene = busy_scene();
    const ClothState here = after(scene, 4), there = after(moved(scene, pose), 4);
    const Points back = there.x.rowwise() - pose.translation().transpose();
    EXPECT_LE(max_distance(back, here.x), tolerance());
}

TEST_P(StepperContract, ASceneTurnedAboutTheVerticalMovesAlike) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::yaw_equivariance);
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(1.1, Vec3::UnitY()).toRotationMatrix();
    const SolverScene scene = busy_scene();
    // Rounding grows from step to step, and differs in code that sanitizers made.
    const int steps = is_sanitized ? 2 : 4;
    const ClothState here = after(scene, steps), there = after(moved(scene, pose), steps);
    EXPECT_LE(max_distance(there.x * pose.linear(), here.x), tolerance());
}

TEST_P(StepperContract, ASceneTurnedByAnyAngleMovesAlikeAtFirst) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::yaw_equivariance);
    const SolverScene scene = busy_scene();
    for (const double angle : {2.3, 3.6, 5.0}) {
        Pose pose = Pose::Identity();
        pose.linear() = Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix();
        for (const int steps : {1, 2}) {
            const ClothState here = after(scene, steps), there = after(moved(scene, pose), steps);
            EXPECT_LE(max_distance(there.x * pose.linear(), here.x), tolerance())
                << "turned by " << angle << ", " << steps << " steps";
        }
    }
}

TEST_P(StepperContract, TheOrderOfVerticesAndFacesDoesNotMatter) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::permutation_invariance);
    const SolverScene scene = busy_scene();
    std::vector<int> order(static_cast<size_t>(scene.garment.vertex_count()));
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(4);
    // Not std::shuffle, whose result the standard leaves open.
    for (size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random() % (i + 1)]);
    const ClothState plain = after(scene, 3), other = after(renumbered(scene, order), 3);
    EXPECT_LE(max_distance(other.x, rows_of(plain.x, order)), tolerance());
}

TEST_P(StepperContract, TakesAnyTimeStep) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::any_time_step);
    SolverScene scene = busy_scene();
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    ASSERT_TRUE(stepper->accepts_any_dt());
    for (const double h : {0.1, 1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0, 1e-4}) {
        ClothState state = scene.state;
        ASSERT_TRUE(stepper->step(scene.boundary, h, state).finite) << h;
        EXPECT_DOUBLE_EQ(state.time, h);
        // A small step moves a little: by the velocity, gravity and the pull of the pins.
        EXPECT_LE(max_distance(state.x, scene.state.x), 3.0 * h + 10.0 * h * h) << h;
        EXPECT_TRUE(same_bits(rows_of(state.x, scene.garment.pins()), scene.boundary.pin_targets));
    }
}

TEST_P(StepperContract, NothingEndsInsideAnObstacle) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::stays_outside);
    SolverScene scene = sheet_on_sphere(9);
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    Obstacle& ball = scene.boundary.obstacles[0];
    for (int k = 0; k < 20; ++k) {
        // The ball rises at 3 m/s for a while.
        ball.pose0 = ball.pose1;
        if (k >= 5 && k < 10) ball.pose1.translation()[1] += 3.0 * dt(*stepper);
        const StepReport report = stepper->step(scene.boundary, dt(*stepper), scene.state);
        ASSERT_TRUE(report.finite) << "step " << k;
        VectorX distance;
        Proximity().signed_distance(scene.state.x, scene.boundary, StepEnd::end, distance);
        EXPECT_GE(distance.minCoeff(), -1e-3) << "step " << k;
        // Edges and faces that are not deeper than is allowed are reported as not inside.
        Proximity proximity;
        const double depth =
            measure_penetration(proximity, scene.boundary, scene.garment, scene.state.x).max_depth;
        EXPECT_NEAR(report.max_penetration, depth, 7e-4) << "step " << k;
    }
}

TEST_P(StepperContract, WithoutSurfaceProjectionVerticesStayOutside) {
    CLOTH_SKIP_UNLESS_PROMISED(Promise::stays_outside);
    SolverScene scene = sheet_on_sphere(9);
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    if (!stepper->set_surface_projection(false)) GTEST_SKIP() << "it keeps to what it does";
    for (int k = 0; k < 20; ++k) {
        const StepReport report = stepper->step(scene.boundary, dt(*stepper), scene.state);
        ASSERT_TRUE(report.finite) << "step " << k;
        VectorX distance;
        Proximity().signed_distance(scene.state.x, scene.boundary, StepEnd::end, distance);
        EXPECT_GE(distance.minCoeff(), -1e-3) << "step " << k;
        EXPECT_NEAR(report.max_penetration, std::max(0.0, -distance.minCoeff()), 1e-9) << k;
    }
}

TEST_P(StepperContract, WildInputGivesFiniteOutputOrIsRefused) {
    using Spoil = std::function<void(SolverScene&)>;
    const std::map<std::string, Spoil> wild = {
        {"crumpled", [](SolverScene& s) { s.state.x += noise(s.state.x.rows(), 0.5, 1); }},
        {"stretched a hundredfold", [](SolverScene& s) { s.state.x *= 100.0; }},
        {"collapsed to a point", [](SolverScene& s) { s.state.x.setZero(); }},
        {"at 1000 m/s", [](SolverScene& s) { s.state.v.setConstant(1e3); }},
        {"velocities at random", [](SolverScene& s) { s.state.v = noise(81, 1e3, 2); }},
        {"1e150 m away", [](SolverScene& s) { s.state.x.array() += 1e150; }},
        {"inside the obstacle",
         [](SolverScene& s) { s.state.x.rowwise() -= Vec3(0, 0.12, 0).transpose(); }},
        {"pins torn away", [](SolverScene& s) { s.boundary.pin_targets.array() += 50.0; }},
        {"gravity of 1e6 m/s^2", [](SolverScene& s) { s.boundary.gravity *= 1e5; }},
    };
    for (const auto& [name, spoil] : wild) {
        SolverScene scene = busy_scene();
        spoil(scene);
        const std::unique_ptr<Stepper> stepper = make(scene.garment);
        for (int k = 0; k < 3; ++k) {
            const ClothState before = scene.state;
            const StepReport report = stepper->step(scene.boundary, dt(*stepper), scene.state);
            EXPECT_TRUE(scene.state.x.allFinite() && scene.state.v.allFinite()) << name;
            EXPECT_TRUE(report.finite || same_bits(scene.state, before)) << name;
        }
    }
}

TEST_P(StepperContract, EqualInputsGiveEqualBits) {
    const SolverScene scene = busy_scene();
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    const auto run = [&] {
        ClothState state = scene.state;
        for (int k = 0; k < 4; ++k) stepper->step(scene.boundary, dt(*stepper), state);
        return state;
    };
    const ClothState first = run();
    EXPECT_TRUE(same_bits(first, run())) << "what a stepper did before must not matter";
    EXPECT_TRUE(same_bits(first, after(scene, 4))) << "nor which of two equal steppers it is";
}

TEST_P(StepperContract, TheNumberOfThreadsDoesNotMatter) {
    // Enough vertices that code with a threshold does use its threads.
    SolverScene scene = swinging_sheet(24);
    scene.boundary.obstacles.push_back(sphere(Vec3(0.25, -0.11, 0.3), 0.1));
    const int usual = omp_get_max_threads();
    omp_set_num_threads(1);
    const ClothState one = after(scene, 3);
    for (const int threads : {2, 3, 4}) {
        omp_set_num_threads(threads);
        EXPECT_TRUE(same_bits(one, after(scene, 3))) << threads << " threads";
    }
    omp_set_num_threads(usual);
}

TEST_P(StepperContract, AFailedStepLeavesTheStateUntouched) {
    using Spoil = std::function<void(SolverScene&, double& h)>;
    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::map<std::string, Spoil> bad = {
        {"position", [](SolverScene& s, double&) { s.state.x(40, 1) = nan; }},
        {"velocity", [](SolverScene& s, double&) { s.state.v(40, 1) = nan; }},
        {"infinite velocity", [](SolverScene& s, double&) { s.state.v(40, 1) = 1.0 / 0.0; }},
        {"pin target", [](SolverScene& s, double&) { s.boundary.pin_targets(1, 2) = nan; }},
        {"missing pin targets",
         [](SolverScene& s, double&) { s.boundary.pin_targets.resize(0, 3); }},
        {"gravity", [](SolverScene& s, double&) { s.boundary.gravity[1] = nan; }},
        {"wind", [](SolverScene& s, double&) { s.boundary.accelerations.setConstant(81, 3, nan); }},
        {"wind of another size",
         [](SolverScene& s, double&) { s.boundary.accelerations.setZero(5, 3); }},
        {"obstacle",
         [](SolverScene& s, double&) { s.boundary.obstacles[0].pose1.translation()[0] = nan; }},
        {"too few vertices", [](SolverScene& s, double&) { s.state.x.conservativeResize(80, 3); }},
        {"time step", [](SolverScene&, double& h) { h = nan; }},
        {"no time step", [](SolverScene&, double& h) { h = 0.0; }},
        {"negative time step", [](SolverScene&, double& h) { h = -h; }},
    };
    for (const auto& [name, spoil] : bad) {
        SolverScene scene = busy_scene();
        const std::unique_ptr<Stepper> stepper = make(scene.garment);
        double h = dt(*stepper);
        spoil(scene, h);
        const ClothState before = scene.state;
        EXPECT_FALSE(stepper->step(scene.boundary, h, scene.state).finite) << name;
        EXPECT_TRUE(same_bits(scene.state, before)) << name;

        SolverScene good = busy_scene();
        EXPECT_TRUE(stepper->step(good.boundary, dt(*stepper), good.state).finite)
            << "the stepper must go on after " << name;
        EXPECT_TRUE(same_bits(good.state, after(busy_scene(), 1))) << "as if nothing was: " << name;
    }
}

TEST_P(StepperContract, ReportsWhatHappened) {
    SolverScene scene = busy_scene();
    const std::unique_ptr<Stepper> stepper = make(scene.garment);
    EXPECT_FALSE(stepper->name().empty());
    const StepReport report = stepper->step(scene.boundary, dt(*stepper), scene.state);
    EXPECT_GE(report.iterations, 0);
    EXPECT_GE(report.residual.value_or(0.0), 0.0);
    EXPECT_GE(report.max_penetration, 0.0);
    const StageTimes& times = report.times;
    for (const double stage : {times.proximity, times.features, times.solve, times.contact})
        EXPECT_GE(stage, 0.0);
    EXPECT_GT(times.total(), 0.0);
}

}  // namespace cloth::test
