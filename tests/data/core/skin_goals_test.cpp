#include "data/core/skin_goals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "data/core/errors.h"
#include "data/core/garment_pieces.h"

namespace cloth::skin_goals_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Garment two_faces(std::vector<int> pins = {}) {
    TriMesh mesh{Points(4, 3), Faces(2, 3)};
    mesh.vertices << 0, 0, 0, 0, 0, 0.1, 0.1, 0, 0, 0.1, 0, 0.1;
    mesh.faces << 0, 1, 2, 2, 1, 3;
    return Garment("two faces", mesh, Fabric::soft_cotton(), std::move(pins));
}

VectorX filled(double value) {
    return VectorX::Constant(4, value);
}

TEST(GoalLimits, AreEmptyUnlessAVertexIsLimitedOrDriven) {
    GoalLimits limits;
    EXPECT_TRUE(limits.empty());
    limits.max_distance = limits.backstop = filled(infinity);
    limits.drive_stiffness = limits.drive_damping = filled(0.0);
    EXPECT_TRUE(limits.empty());
    limits.drive_damping[2] = 1.0;
    EXPECT_FALSE(limits.empty());
    EXPECT_FALSE(limits.has_backstops());
    limits.backstop[1] = 0.0;
    EXPECT_TRUE(limits.has_backstops());
}

TEST(GoalLimits, WrongSizesAndValuesAreRefusedByName) {
    const auto message = [](VectorX GoalLimits::*which, const VectorX& values) {
        GoalLimits limits;
        limits.*which = values;
        try {
            two_faces().with_goals(limits);
        } catch (const ArgumentError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [which, name, most] :
         {std::make_tuple(&GoalLimits::max_distance, "max_distance", infinity),
          std::make_tuple(&GoalLimits::backstop, "backstop", infinity),
          std::make_tuple(&GoalLimits::drive_stiffness, "drive_stiffness", 1e6),
          std::make_tuple(&GoalLimits::drive_damping, "drive_damping", 1e4)}) {
        EXPECT_EQ(message(which, filled(0.0)), "");
        EXPECT_EQ(message(which, filled(most)), "");
        EXPECT_NE(message(which, filled(-1e-9)).find(name), std::string::npos) << name;
        EXPECT_NE(message(which, filled(nan)).find("[0]"), std::string::npos) << name;
        EXPECT_NE(message(which, VectorX::Zero(3)).find("3 values"), std::string::npos) << name;
        if (std::isfinite(most)) {
            EXPECT_NE(message(which, filled(1.01 * most)), "") << name;
        }
    }
}

TEST(GoalLimits, StayWithTheGarmentAndItsMergers) {
    GoalLimits limits;
    limits.max_distance = filled(0.1);
    limits.drive_stiffness = filled(5.0);
    const Garment driven = two_faces().with_goals(limits);
    EXPECT_TRUE(driven.has_goals());
    EXPECT_FALSE(two_faces().has_goals());
    EXPECT_EQ(driven.with_pins({1}).goal_limits().max_distance, limits.max_distance);
    EXPECT_EQ(driven.with_fabric(Fabric::real_cotton()).goal_limits().drive_stiffness,
              limits.drive_stiffness);
    const Garment merged = merge_garments("both", {two_faces(), driven}).garment;
    VectorX distance(8), stiffness(8);
    distance << filled(infinity), filled(0.1);
    stiffness << filled(0.0), filled(5.0);
    EXPECT_EQ(merged.goal_limits().max_distance, distance);
    EXPECT_EQ(merged.goal_limits().drive_stiffness, stiffness);
    EXPECT_EQ(merged.goal_limits().backstop.size(), 0);
}

TEST(GoalLimits, WhatNeverLeavesItsGoalIsHeldAsPinsAre) {
    GoalLimits limits;
    limits.max_distance = filled(0.1);
    limits.max_distance[2] = 0.0;
    const Garment garment = two_faces().with_goals(limits).with_pins({1});
    EXPECT_EQ(garment.is_held(), (std::vector<char>{0, 1, 1, 0}));
    VectorX mobilities = garment.masses().cwiseInverse();
    mobilities[1] = mobilities[2] = 0.0;
    EXPECT_EQ(garment.mobilities(), mobilities);
    EXPECT_EQ(two_faces().mobilities(), two_faces().inverse_masses());
}

TEST(SkinGoals, FitOnlyWithSizesNumbersAndNormals) {
    GoalLimits limits;
    const Points x = two_faces().rest().vertices;
    const Points normals = Points::Ones(4, 3);
    EXPECT_TRUE(are_goals_for(limits, {}, 4)) << "none are asked for";
    limits.max_distance = filled(0.1);
    EXPECT_FALSE(are_goals_for(limits, {}, 4));
    EXPECT_TRUE(are_goals_for(limits, SkinGoals::at(x), 4));
    EXPECT_FALSE(are_goals_for(limits, SkinGoals::at(x.topRows(3)), 4));
    SkinGoals broken = SkinGoals::at(x);
    broken.x0(2, 1) = infinity;
    EXPECT_FALSE(are_goals_for(limits, broken, 4));
    limits.backstop = filled(0.1);
    EXPECT_FALSE(are_goals_for(limits, SkinGoals::at(x), 4));
    EXPECT_TRUE(are_goals_for(limits, SkinGoals::at(x, normals), 4));
}

TEST(VertexGoal, WithinIsAllowedAndLeavesWhatIsAllowedAsItIs) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
    for (int k = 0; k < 2000; ++k) {
        const double backstop = k % 3 == 0 ? 0.0 : std::abs(normal(random));
        const double distance = k % 5 == 0 ? 0.0 : std::abs(normal(random));
        const Vec3 direction = k % 4 == 0 ? Vec3::Zero() : Vec3(vector().normalized());
        const VertexGoal goal{0, vector(), direction, distance, backstop};
        const Vec3 x = goal.place + 2.0 * vector();
        const Vec3 moved = goal.within(x);
        EXPECT_LE(goal.excess(moved), 1e-12);
        EXPECT_LE((moved - x).norm(), 2.0 * goal.excess(x) + 1e-12) << "at most both corrections";
        if (goal.excess(x) == 0.0) {
            EXPECT_EQ(moved, x);
        }
        EXPECT_EQ(goal.excess(goal.place), 0.0) << "the goal itself is always allowed";
    }
}

TEST(VertexGoal, IsTakenForWhatIsLimitedAndNotPinned) {
    GoalLimits limits;
    limits.max_distance = filled(infinity);
    limits.max_distance[0] = limits.max_distance[3] = 0.2;
    limits.backstop = filled(infinity);
    limits.backstop[1] = limits.backstop[2] = 0.01;
    const Garment garment = two_faces({0});
    SkinGoals goals = SkinGoals::at(garment.rest().vertices, Points::Zero(4, 3));
    goals.x1.array() += 1.0;
    goals.normal0.row(1) << 0, 2, 0;
    goals.normal1.row(1) << 0, 0, 2;
    std::vector<VertexGoal> taken;
    take_goals(limits, goals, garment.is_pinned(), 0.5, taken);
    ASSERT_EQ(taken.size(), 2u) << "0 is pinned, 2 has no normal";
    EXPECT_EQ(taken[0].vertex, 1);
    EXPECT_NEAR((taken[0].normal - Vec3(0, 1, 1).normalized()).norm(), 0.0, 1e-15);
    EXPECT_EQ(taken[1].vertex, 3);
    EXPECT_TRUE(taken[1].normal.isZero(0.0));
    EXPECT_NEAR((taken[1].place - Vec3(0.6, 0.5, 0.6)).norm(), 0.0, 1e-15);
}

}  // namespace
}  // namespace cloth::skin_goals_test
