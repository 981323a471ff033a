#include "gnn/physics/stepper/guess.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::guess_test {
namespace {

using test::plane_contacts;
using test::sheet_on_sphere;
using test::SolverScene;
using test::swinging_sheet;

constexpr double dt = 1.0 / 30.0;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(LinearExtrapolation, RepeatsTheLastMotionWithoutGravity) {
    const SolverScene scene = swinging_sheet(5);
    Points x;
    linear_extrapolation(scene.state, dt, x);
    const Points before = scene.state.x - dt * scene.state.v;
    EXPECT_TRUE(x.isApprox(2.0 * scene.state.x - before, 1e-14));
}

TEST(ProjectedExtrapolation, StopsVerticesAtTheContactDistanceOfTheMovedPlane) {
    SolverScene scene = swinging_sheet(5);
    scene.state.x.col(1).setConstant(0.01);
    scene.state.v.col(1).setConstant(-1.0);
    scene.state.v(7, 1) = 2.0;
    // The plane rises by 5 mm during the step.
    const SurfaceContacts contacts =
        plane_contacts(scene.state.x, Vec3::Zero(), Vec3::UnitY(), Vec3(0, 5e-3, 0));
    Points x, free;
    projected_extrapolation(scene.state, contacts, dt, 4e-3, x);
    linear_extrapolation(scene.state, dt, free);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        EXPECT_NEAR(x(i, 1), i == 7 ? free(7, 1) : 9e-3, 1e-15) << "vertex " << i;
    EXPECT_EQ(x.col(0), free.col(0)) << "the push is along the normal";
}

TEST(ProjectedExtrapolation, WithoutContactsIsTheLinearExtrapolation) {
    const SolverScene scene = swinging_sheet(4);
    Points x, free;
    projected_extrapolation(scene.state, {}, dt, 4e-3, x);
    linear_extrapolation(scene.state, dt, free);
    EXPECT_EQ(x, free);
}

TEST(StartingGuess, PutsPinsOnTheirTargetsInTheOrderOfThePins) {
    SolverScene scene = swinging_sheet(5);
    scene.boundary.pin_targets << 1, 2, 3, 4, 5, 6;
    Points x;
    starting_guess(scene.garment, scene.state, scene.boundary, {}, dt, 4e-3, x);
    EXPECT_EQ(x.row(0), Eigen::RowVector3d(1, 2, 3));
    EXPECT_EQ(x.row(4), Eigen::RowVector3d(4, 5, 6));
}

TEST(RestingGuess, KeepsWhatTouchesAsDeepAsItWas) {
    SolverScene scene = swinging_sheet(4);
    scene.state.x.col(1).setConstant(0.01);
    scene.state.x(5, 1) = 3.95e-3;  // within the contact distance of the plane
    scene.state.x(6, 1) = 1e-3;     // deep
    scene.state.v.col(1).setConstant(-1.0);
    scene.state.v(7, 1) = 2.0;
    scene.boundary.pin_targets.setConstant(0.3);
    const SurfaceContacts contacts =
        plane_contacts(scene.state.x, Vec3::Zero(), Vec3::UnitY(), Vec3(0, 5e-3, 0));
    Points x, free;
    resting_guess(scene.garment, scene.state, scene.boundary, contacts, dt, 4e-3, x);
    linear_extrapolation(scene.state, dt, free);
    EXPECT_NEAR(x(5, 1), 5e-3 + 3.95e-3, 1e-15);
    EXPECT_NEAR(x(6, 1), 5e-3 + 3.7e-3, 1e-15) << "0.3 mm deep at most";
    EXPECT_EQ(x(7, 1), free(7, 1)) << "it leaves the plane";
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const bool pinned = scene.garment.is_pinned()[static_cast<size_t>(i)] != 0;
        if (pinned || i < 5 || i > 7) {
            EXPECT_NEAR(x(i, 1), pinned ? 0.3 : 9e-3, 1e-15) << "vertex " << i;
        }
    }
}

TEST(RestingGuess, AwayFromObstaclesIsTheStartingGuess) {
    const SolverScene scene = swinging_sheet(5);
    Points x, other;
    resting_guess(scene.garment, scene.state, scene.boundary, {}, dt, 4e-3, x);
    starting_guess(scene.garment, scene.state, scene.boundary, {}, dt, 4e-3, other);
    EXPECT_EQ(x, other);
}

TEST(IsValidStep, AcceptsAnOrdinaryStep) {
    const SolverScene scene = sheet_on_sphere(4);
    EXPECT_TRUE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
}

TEST(IsValidStep, RefusesEveryNumberThatIsNotFinite) {
    const SolverScene good = swinging_sheet(4);
    const auto refused = [&](auto spoil) {
        SolverScene scene = good;
        scene.boundary.obstacles = sheet_on_sphere(4).boundary.obstacles;
        scene.boundary.accelerations.setZero(scene.garment.vertex_count(), 3);
        EXPECT_TRUE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
        spoil(scene);
        return !is_valid_step(scene.garment, scene.state, scene.boundary, dt);
    };
    EXPECT_TRUE(refused([](SolverScene& s) { s.state.x(3, 1) = nan; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.state.v(0, 2) = 1.0 / 0.0; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.boundary.pin_targets(1, 0) = nan; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.boundary.gravity[0] = nan; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.boundary.accelerations(2, 2) = nan; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.boundary.obstacles[0].radius = nan; }));
    EXPECT_TRUE(refused([](SolverScene& s) { s.boundary.obstacles[0].friction = nan; }));
    EXPECT_TRUE(
        refused([](SolverScene& s) { s.boundary.obstacles[0].pose1.translation()[0] = nan; }));
}

TEST(IsValidStep, RefusesWrongSizesAndTimeSteps) {
    const SolverScene good = swinging_sheet(4);
    for (const double wrong : {0.0, -dt, nan, 1.0 / 0.0})
        EXPECT_FALSE(is_valid_step(good.garment, good.state, good.boundary, wrong));
    SolverScene scene = good;
    scene.state.x.conservativeResize(3, 3);
    EXPECT_FALSE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
    scene = good;
    scene.boundary.pin_targets.resize(1, 3);
    scene.boundary.pin_targets.setZero();
    EXPECT_FALSE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
    scene = good;
    scene.boundary.accelerations.setZero(2, 3);
    EXPECT_FALSE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
    scene = good;
    scene.boundary.pinched.assign(scene.garment.masses().size(), 1);
    EXPECT_TRUE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
    scene.boundary.pinched.pop_back();
    EXPECT_FALSE(is_valid_step(scene.garment, scene.state, scene.boundary, dt));
}

}  // namespace
}  // namespace cloth::guess_test
