#include "demos/viewer/cloth_pull.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "data/core/errors.h"
#include "data/core/garment_pieces.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::viewer_pull_test {

namespace {

Garment sheet_garment() {
    return {"sheet", cloth::test::sheet(20, 0.4), Fabric::soft_cotton()};
}

/// The vertex nearest to the sheet's middle.
int middle_of(const Garment& garment) {
    const Points& x = garment.rest().vertices;
    const Eigen::RowVector3d middle = x.colwise().mean();
    Eigen::Index nearest;
    (x.rowwise() - middle).rowwise().norm().minCoeff(&nearest);
    return static_cast<int>(nearest);
}

std::string refusal(int vertex, const PullSettings& settings) {
    try {
        ClothPull(sheet_garment(), vertex, settings);
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(ViewerPull, DrivesOfThePatchSumToTheStiffness) {
    const Garment sheet = sheet_garment();
    PullSettings settings;
    settings.stiffness = 30.0;
    const ClothPull pull(sheet, middle_of(sheet), settings);
    EXPECT_GT(pull.patch().size(), 5u);
    const VectorX drive = pull.limits().drive_stiffness;
    EXPECT_NEAR(drive.dot(sheet.masses()), 30.0, 1e-9);
    for (Eigen::Index i = 0; i < drive.size(); ++i) {
        const auto& patch = pull.patch();
        const bool inside = std::find(patch.begin(), patch.end(), i) != patch.end();
        const double away =
            (sheet.rest().vertices.row(i) - sheet.rest().vertices.row(pull.vertex())).norm();
        EXPECT_EQ(inside, away < settings.radius) << i;
        EXPECT_EQ(drive[i] > 0.0, inside) << i;
        EXPECT_LE(drive[i], drive[pull.vertex()]);
    }
}

TEST(ViewerPull, AHandDoesNotPullClothBeyondItsOwnGoals) {
    const Garment sheet = sheet_garment();
    const int middle = middle_of(sheet);
    const ClothPull pull(sheet, middle);
    GoalLimits own;
    own.max_distance.setConstant(sheet.vertex_count(), 0.03);
    own.max_distance[0] = 0.0;
    own.drive_damping.setConstant(sheet.vertex_count(), 2.0);
    const Points& x = sheet.rest().vertices;
    const SkinGoals skin = SkinGoals::at(x);

    const GoalLimits limits = pull.limits(own);
    check(limits, sheet.vertex_count(), "limits");
    const SkinGoals goals = pull.goals(x, x.row(middle).transpose() + Vec3(0, 0.1, 0), own, skin);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const auto& patch = pull.patch();
        if (std::find(patch.begin(), patch.end(), i) == patch.end()) {
            EXPECT_EQ(limits.max_distance[i], own.max_distance[i]) << "free of the hand";
            EXPECT_EQ(limits.drive_damping[i], 2.0);
            EXPECT_EQ(goals.x1.row(i), skin.x1.row(i));
        } else {
            EXPECT_NEAR((goals.x1.row(i) - x.row(i)).norm(), 0.03, 1e-12) << "up to its limit";
            EXPECT_GT(limits.drive_stiffness[i], 0.0);
        }
    }
    EXPECT_EQ(pull.goals(x, x.row(middle).transpose() + Vec3(0, 0.01, 0), own, skin).x1.row(middle),
              x.row(middle) + Eigen::RowVector3d(0, 0.01, 0))
        << "within its limit";
}

TEST(ViewerPull, ALayerBelowIsLeftOut) {
    const Garment over = sheet_garment();
    TriMesh mesh = over.rest();
    mesh.vertices.col(1).array() -= 5e-3;
    const Garment both =
        merge_garments("both", {over, Garment("under", mesh, over.fabric())}).garment;
    const ClothPull pull(both, middle_of(over));
    for (const int i : pull.patch()) EXPECT_LT(i, over.vertex_count());
}

TEST(ViewerPull, PullsNoFartherThanTheLargestDistance) {
    const Garment sheet = sheet_garment();
    const int vertex = middle_of(sheet);
    PullSettings settings;
    settings.max_distance = 0.1;
    const ClothPull pull(sheet, vertex, settings);
    const Points& x = sheet.rest().vertices;
    const Vec3 place = x.row(vertex).transpose();
    for (const double away : {0.05, 2.0}) {
        const SkinGoals goals = pull.goals(x, place + Vec3(0, away, 0));
        EXPECT_EQ(goals.x0, x);
        const double expected = std::min(away, 0.1);
        for (const int i : pull.patch())
            EXPECT_NEAR((goals.x1.row(i) - x.row(i) - Eigen::RowVector3d(0, expected, 0)).norm(),
                        0.0, 1e-12);
    }
}

TEST(ViewerPull, WhatCannotBePulledIsRefusedByName) {
    PullSettings settings;
    EXPECT_EQ(refusal(0, settings), "");
    EXPECT_NE(refusal(-1, settings).find("vertex"), std::string::npos);
    EXPECT_NE(refusal(100000, settings).find("vertex"), std::string::npos);
    settings.stiffness = 0.5;
    EXPECT_NE(refusal(0, settings).find("PullSettings.stiffness"), std::string::npos);
    settings = {};
    settings.radius = 1.0;
    EXPECT_NE(refusal(0, settings).find("PullSettings.radius"), std::string::npos);
    settings = {};
    settings.max_distance = 0.0;
    EXPECT_NE(refusal(0, settings).find("PullSettings.max_distance"), std::string::npos);
}

}  // namespace cloth::viewer_pull_test
