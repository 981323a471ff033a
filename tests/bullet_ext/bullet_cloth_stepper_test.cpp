#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bullet_ext/bulletClothStepper.h"
#include "data/core/errors.h"
#include "tests/test_meshes.h"

using namespace cloth;
using namespace cloth::test;

namespace cloth {
void PrintTo(const BulletClothSettings& settings, std::ostream* out) {
    *out << settings.name;
}
}  // namespace cloth

namespace {

constexpr double kFrame = 1.0 / 30.0;

/// How deep Bullet lets cloth go (m): at 1/60 s it does, see the settings' names.
double tolerated_depth(const BulletClothSettings& settings) {
    return settings.name == "bullet" ? 0.01 : 2e-3;
}

class EverySetting : public testing::TestWithParam<BulletClothSettings> {};
INSTANTIATE_TEST_SUITE_P(Bullet, EverySetting,
                         testing::Values(BulletClothSettings::shipped(),
                                         BulletClothSettings::fine()),
                         [](const auto& param) {
                             return param.param.name == "bullet" ? "shipped" : "fine";
                         });

Boundary boundary_of(const Garment& garment, const ClothState& state) {
    Boundary boundary;
    boundary.pin_targets.resize(static_cast<Eigen::Index>(garment.pins().size()), 3);
    for (size_t p = 0; p < garment.pins().size(); ++p)
        boundary.pin_targets.row(static_cast<Eigen::Index>(p)) = state.x.row(garment.pins()[p]);
    return boundary;
}

/// A sheet that lies just above an obstacle.
ClothState above(const Garment& garment, double height) {
    ClothState state = ClothState::at_rest(garment);
    state.x.col(0).array() -= 0.5;
    state.x.col(2).array() -= 0.5;
    state.x.col(1).array() += height;
    return state;
}

double deepest_in_sphere(const Points& x, const Vec3& centre, double radius) {
    return radius - (x.rowwise() - centre.transpose()).rowwise().norm().minCoeff();
}

}  // namespace

TEST(BulletClothSettings, NamesSayWhatIsRun) {
    EXPECT_EQ(BulletClothSettings::shipped().name, "bullet");
    EXPECT_EQ(BulletClothSettings::shipped(50).name, "bullet-50");
    EXPECT_EQ(BulletClothSettings::fine().name, "bullet-fine");
}

TEST_P(EverySetting, FreeFallIsSemiImplicitEulerOfTheSubSteps) {
    const Garment garment("sheet", square_mesh(6), Fabric::soft_cotton());
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = above(garment, 3.0);
    for (int i = 0; i < 15; ++i) {
        const StepReport report = stepper.step(boundary_of(garment, state), kFrame, state);
        ASSERT_TRUE(report.finite);
    }
    const double h = GetParam().substep_dt;
    const double n = std::round(15 * kFrame / h);
    EXPECT_NEAR(state.x(7, 1) - 3.0, -9.81 * h * h * n * (n + 1) / 2, 1e-3);
    EXPECT_NEAR(state.v(7, 1), -9.81 * 0.5, 9.81 / 60);  // mean velocity of the last frame
    EXPECT_NEAR(state.time, 0.5, 1e-12);
}

TEST_P(EverySetting, PinsLandOnTheirTargets) {
    const Garment garment("sheet", square_mesh(6), Fabric::soft_cotton(), {0, 5});
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = ClothState::at_rest(garment);
    for (int i = 0; i < 10; ++i) {
        Boundary boundary = boundary_of(garment, state);
        boundary.pin_targets.col(1).array() += 0.02;
        ASSERT_TRUE(stepper.step(boundary, kFrame, state).finite);
        EXPECT_EQ(state.x.row(0), boundary.pin_targets.row(0));
        EXPECT_EQ(state.x.row(5), boundary.pin_targets.row(1));
    }
    EXPECT_LT(state.x(30, 1), state.x(0, 1));
}

TEST_P(EverySetting, ExternalAccelerationActsLikeGravity) {
    const Garment garment("sheet", square_mesh(4), Fabric::soft_cotton());
    ClothState a = above(garment, 0.0), b = a;
    Boundary boundary = boundary_of(garment, a);
    BulletClothStepper first(garment, GetParam()), second(garment, GetParam());
    first.step(boundary, kFrame, a);
    boundary.accelerations = Points::Zero(16, 3);
    boundary.accelerations.rowwise() += boundary.gravity.transpose();
    boundary.gravity.setZero();
    second.step(boundary, kFrame, b);
    EXPECT_NEAR((a.x - b.x).cwiseAbs().maxCoeff(), 0.0, 1e-6);
}

TEST_P(EverySetting, SheetStaysOutsideASphere) {
    const Garment garment("sheet", square_mesh(21), Fabric::soft_cotton());
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = above(garment, 0.32);
    Boundary boundary = boundary_of(garment, state);
    boundary.obstacles.resize(1);
    boundary.obstacles[0].shape = ObstacleShape::sphere;
    boundary.obstacles[0].radius = 0.3;
    for (int i = 0; i < 30; ++i) {
        ASSERT_TRUE(stepper.step(boundary, kFrame, state).finite);
        EXPECT_LT(deepest_in_sphere(state.x, Vec3::Zero(), 0.3), tolerated_depth(GetParam())) << i;
    }
    EXPECT_GT(state.x(10 * 21 + 10, 1), 0.29);  // lies on the sphere
    EXPECT_LT(state.x(0, 1), 0.1);              // its corners hang
}

TEST_P(EverySetting, MeshObstacleCarriesClothAsItsHulls) {
    const Garment garment("sheet", square_mesh(21), Fabric::soft_cotton());
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = above(garment, 0.32);
    const TriMesh ball = sphere_mesh(0.3, 16);
    Boundary boundary = boundary_of(garment, state);
    boundary.obstacles.resize(1);
    Obstacle& obstacle = boundary.obstacles[0];
    obstacle.faces = std::make_shared<const Faces>(ball.faces);
    obstacle.x1 = ball.vertices;
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 20; ++i) {
        obstacle.x0 = obstacle.x1;
        centre.y() += 0.005;
        obstacle.x1.col(1).array() += 0.005;
        ASSERT_TRUE(stepper.step(boundary, kFrame, state).finite);
        EXPECT_LT(deepest_in_sphere(state.x, centre, 0.3), 0.012) << i;
    }
    EXPECT_GT(state.x(10 * 21 + 10, 1), centre.y() + 0.29);
}

TEST_P(EverySetting, PlaneAndBoxHoldCloth) {
    for (ObstacleShape shape : {ObstacleShape::plane, ObstacleShape::box}) {
        const Garment garment("sheet", square_mesh(9), Fabric::soft_cotton());
        BulletClothStepper stepper(garment, GetParam());
        ClothState state = above(garment, 0.05);
        Boundary boundary = boundary_of(garment, state);
        boundary.obstacles.resize(1);
        boundary.obstacles[0].shape = shape;
        boundary.obstacles[0].half_extents = Vec3(1, 0.1, 1);
        if (shape == ObstacleShape::box)
            boundary.obstacles[0].pose0.translation().y() =
                boundary.obstacles[0].pose1.translation().y() = -0.1;
        for (int i = 0; i < 30; ++i) ASSERT_TRUE(stepper.step(boundary, kFrame, state).finite);
        EXPECT_GT(state.x.col(1).minCoeff(), 0.0);
        EXPECT_LT(state.x.col(1).mean(), 0.025);
    }
}

TEST_P(EverySetting, GoingOnKeepsBulletsVelocitiesAndACheckpointIsReproducible) {
    const Garment garment("sheet", square_mesh(9), Fabric::soft_cotton(), {0, 8});
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = ClothState::at_rest(garment);
    for (int i = 0; i < 5; ++i) stepper.step(boundary_of(garment, state), kFrame, state);
    const ClothState checkpoint = state;
    stepper.step(boundary_of(garment, state), kFrame, state);
    ClothState again = checkpoint, other = checkpoint;
    stepper.step(boundary_of(garment, again), kFrame, again);
    BulletClothStepper fresh(garment, GetParam());
    fresh.step(boundary_of(garment, other), kFrame, other);
    EXPECT_EQ(again.x, other.x);
    EXPECT_EQ(again.v, other.v);
    // Gravity's share of the sub-steps that the mean velocity does not know.
    EXPECT_NEAR((again.x - state.x).cwiseAbs().maxCoeff(), 0.0, 9.81 * kFrame * kFrame);
}

TEST_P(EverySetting, StiffnessHoldsTheSheetTogether) {
    const Garment garment("sheet", square_mesh(17), Fabric::soft_cotton(), {0, 16});
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = ClothState::at_rest(garment);
    double lowest = 0.0;
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(stepper.step(boundary_of(garment, state), kFrame, state).finite);
        lowest = std::min(lowest, state.x.col(1).minCoeff());
    }
    double mean = 0.0;
    for (const auto& [a, b] : garment.edges())
        mean += (state.x.row(a) - state.x.row(b)).norm() /
                (garment.rest().vertices.row(a) - garment.rest().vertices.row(b)).norm();
    mean /= static_cast<double>(garment.edges().size());
    EXPECT_NEAR(mean, 1.0, 0.15);
    EXPECT_LT(lowest, -0.7);  // it swings below its pins
}

TEST_P(EverySetting, AFailedStepLeavesTheStateAndTheNextOneWorks) {
    const Garment garment("sheet", square_mesh(6), Fabric::soft_cotton());
    BulletClothStepper stepper(garment, GetParam());
    ClothState state = ClothState::at_rest(garment);
    Boundary bad = boundary_of(garment, state);
    bad.accelerations = Points::Constant(36, 3, std::numeric_limits<double>::infinity());
    EXPECT_FALSE(stepper.step(bad, kFrame, state).finite);
    EXPECT_EQ(state.x, garment.rest().vertices);
    state.x(3, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(stepper.step(boundary_of(garment, state), kFrame, state).finite);
    state = ClothState::at_rest(garment);
    EXPECT_TRUE(stepper.step(boundary_of(garment, state), kFrame, state).finite);
    EXPECT_LT(state.x(0, 1), 0.0);
}

TEST(BulletClothStepper, SettingsOutOfRangeAreRefused) {
    const Garment garment("sheet", square_mesh(4), Fabric::soft_cotton());
    BulletClothSettings settings;
    settings.substep_dt = 0.0;
    EXPECT_THROW(BulletClothStepper(garment, settings), ArgumentError);
    settings = {};
    settings.cloth.iterations = 0;
    EXPECT_THROW(BulletClothStepper(garment, settings), ArgumentError);
}
