#include "collision/response/skin_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "collision/proximity/brute_force.h"
#include "tests/test_meshes.h"

namespace cloth::skin_blend_test {
namespace {

using namespace test;

Points at_angles(double radius, double from, double to, int count) {
    Points x(count, 3);
    for (int i = 0; i < count; ++i) {
        const double angle = from + (to - from) * i / (count - 1.0);
        x.row(i) << radius * std::cos(angle), radius * std::sin(angle), 0.01 * i;
    }
    return x;
}

TEST(SkinBlend, WeightsMixSimulatedAndSkinned) {
    const Points simulated = at_angles(1.0, 0.0, 1.0, 9), skinned = at_angles(2.0, 0.5, 2.0, 9);
    SkinBlend blend;
    blend.follow(simulated, skinned, {});
    EXPECT_EQ(blend.vertices(), simulated) << "0 until something else is said: the same bits";
    for (const double weight : {0.25, 0.5, 1.0}) {
        blend.fade_to(weight);
        EXPECT_EQ(blend.weight(), weight);
        EXPECT_FALSE(blend.is_fading());
        blend.follow(simulated, skinned, {});
        EXPECT_EQ(blend.vertices(), Points((1.0 - weight) * simulated + weight * skinned));
    }
    blend.fade_to(0.0);
    blend.follow(simulated, skinned, {});
    EXPECT_EQ(blend.vertices(), simulated);
}

TEST(SkinBlend, AFadeIsSteadyInTimeWhateverTheStepsAre) {
    for (const double dt : {1.0 / 240, 1.0 / 30, 0.07}) {
        SkinBlend blend;
        blend.fade_to(1.0, 0.5);
        double time = 0.0;
        while (time + dt < 0.5) {
            EXPECT_TRUE(blend.is_fading());
            blend.advance(dt);
            time += dt;
            EXPECT_NEAR(blend.weight(), time / 0.5, 1e-12) << dt;
        }
        blend.advance(dt);
        EXPECT_EQ(blend.weight(), 1.0) << "exactly there";
        EXPECT_FALSE(blend.is_fading());
        blend.advance(dt);
        EXPECT_EQ(blend.weight(), 1.0) << "and no farther";
    }
}

TEST(SkinBlend, AFadeThatIsTurnedRoundGoesOnFromItsWeight) {
    SkinBlend blend;
    blend.fade_to(1.0, 1.0);
    blend.advance(0.4);
    blend.fade_to(0.0, 2.0);
    EXPECT_NEAR(blend.weight(), 0.4, 1e-12);
    blend.advance(1.0);
    EXPECT_NEAR(blend.weight(), 0.2, 1e-12);
    blend.fade_to(blend.weight(), 5.0);
    EXPECT_FALSE(blend.is_fading()) << "it is there";
    for (const double none : {0.0, -1.0, std::nan("")}) blend.advance(none);
    EXPECT_NEAR(blend.weight(), 0.2, 1e-12);
}

/// The straight way between two sides of a limb leads through it.
TEST(SkinBlend, NoVertexIsShownInsideAnObstacle) {
    const Boundary boundary = boundary_of({mesh_obstacle(icosphere(4))});
    const Points simulated = at_angles(1.01, 0.0, 2.5, 40);
    for (const double turn : {0.2, 1.0, 2.0, 3.0}) {
        const Points skinned = at_angles(1.005, turn, 2.5 + turn, 40);
        SkinBlendSettings settings;
        settings.deepest = 1.0;
        SkinBlend blend(settings);
        double deepest = 0.0;
        for (int k = 0; k <= 10; ++k) {
            blend.fade_to(0.1 * k);
            deepest =
                std::max(deepest, blend.follow(simulated, skinned, boundary).max_depth_before);
            for (Eigen::Index i = 0; i < blend.vertices().rows(); ++i)
                ASSERT_GE(brute_force_signed_distance(boundary, StepEnd::end,
                                                      blend.vertices().row(i).transpose()),
                          -1e-7)
                    << turn << ", weight " << 0.1 * k << ", vertex " << i;
        }
        if (turn > 0.5) {
            EXPECT_GT(deepest, 0.05) << "the scene is no test";
        }
    }
}

TEST(SkinBlend, SkinThatIsInsideIsShownOnTheSurface) {
    const Boundary boundary = boundary_of({mesh_obstacle(icosphere(4))});
    const Points simulated = at_angles(1.02, 0.0, 1.0, 20), skinned = 0.95 * simulated;
    SkinBlend blend;
    blend.fade_to(1.0);
    blend.follow(simulated, skinned, boundary);
    for (Eigen::Index i = 0; i < 20; ++i) {
        const double distance = brute_force_signed_distance(boundary, StepEnd::end,
                                                            blend.vertices().row(i).transpose());
        EXPECT_NEAR(distance, 5e-4, 1e-6) << i;
    }
}

/// Two planes that face each other with less room than the distance asks for: pushes go to and
/// fro.
TEST(SkinBlend, WhatNoPushBringsOutIsShownWhereItIsSimulated) {
    Boundary boundary;
    boundary.obstacles.resize(2);
    for (Obstacle& plane : boundary.obstacles) plane.shape = ObstacleShape::plane;
    boundary.obstacles[1].pose0 = boundary.obstacles[1].pose1 =
        Pose(Eigen::Translation3d(0, -0.02, 0) * Eigen::AngleAxisd(std::acos(-1.0), Vec3::UnitX()));
    Points simulated(2, 3), skinned(2, 3);
    simulated << 0, 0.3, 0, 1, 0.3, 0;
    skinned << 0, -0.005, 0, 1, 0.2, 0;
    SkinBlend blend;
    blend.fade_to(1.0);
    blend.follow(simulated, skinned, boundary);
    EXPECT_EQ(blend.vertices().row(0), simulated.row(0));
}

TEST(SkinBlend, LimbsThatAVertexIgnoresDoNotPushIt) {
    Boundary boundary = boundary_of({mesh_obstacle(icosphere(4))});
    Obstacle& ball = boundary.obstacles[0];
    ball.limbs = std::make_shared<const std::vector<std::uint8_t>>(
        static_cast<size_t>(ball.faces->rows()), std::uint8_t{3});
    const Points simulated = at_angles(1.02, 0.0, 1.0, 4), skinned = 0.97 * simulated;
    SkinBlend blend;
    blend.fade_to(1.0);
    blend.follow(simulated, skinned, boundary, {0, LimbSet{1} << 3, 0, 0});
    EXPECT_EQ(blend.vertices().row(1), skinned.row(1));
    EXPECT_GT(blend.vertices().row(2).norm(), 0.99);
}

TEST(SkinBlend, EqualBitsForAnyNumberOfThreads) {
    const Boundary boundary = boundary_of({mesh_obstacle(icosphere(4))});
    const Points simulated = at_angles(1.01, 0.0, 2.5, 400),
                 skinned = at_angles(1.005, 1.0, 3.5, 400);
    SkinBlendSettings settings;
    settings.deepest = 1.0;
    settings.threads = 1;
    SkinBlend one(settings);
    settings.threads = 4;
    SkinBlend four(settings);
    for (SkinBlend* blend : {&one, &four}) {
        blend->fade_to(0.5);
        blend->follow(simulated, skinned, boundary);
    }
    EXPECT_EQ(one.vertices(), four.vertices());
}

TEST(SkinBlend, NumbersThatAreNotFiniteAreNotShown) {
    const Points simulated = at_angles(1.0, 0.0, 1.0, 5);
    Points broken = simulated;
    broken(2, 1) = std::numeric_limits<double>::quiet_NaN();
    SkinBlend blend;
    blend.fade_to(0.5);
    blend.follow(simulated, broken, {});
    EXPECT_EQ(blend.vertices(), simulated) << "the skin is broken";
    blend.follow(simulated, {}, {});
    EXPECT_EQ(blend.vertices(), simulated) << "there is no skin";
    blend.follow(broken, simulated, {});
    EXPECT_EQ(blend.vertices(), simulated) << "the cloth is broken";
}

}  // namespace
}  // namespace cloth::skin_blend_test
