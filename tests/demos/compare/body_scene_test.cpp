#include "demos/compare/body_scene.h"

#include <gtest/gtest.h>

using namespace cloth;

namespace {

BodySceneSettings small_shirt() {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000";
    return settings;
}

}  // namespace

TEST(BodySceneLoss, AShirtInPlaceBelongsToTheScene) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * ComparisonScene::frame_time;
    EXPECT_EQ(scene.loss(scene.boundary(start, start), scene.garment().rest().vertices), "");
}

TEST(BodySceneLoss, AShirtThatFellToTheFeetOrStayedBehindDoesNot) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * ComparisonScene::frame_time;
    Points x = scene.garment().rest().vertices;
    x.col(1).array() -= 0.5;
    EXPECT_EQ(scene.loss(scene.boundary(start, start), x), "slid off the body");
    Boundary gone = scene.boundary(start, start);
    gone.obstacles[0].x1.col(0).array() += 1.0;
    EXPECT_EQ(scene.loss(gone, scene.garment().rest().vertices), "slid off the body");
}

// Crouching moves the mean of the whole body by more than that of the torso.
TEST(BodySceneLoss, LegsThatMoveAloneDoNotCount) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * ComparisonScene::frame_time;
    Boundary boundary = scene.boundary(start, start);
    Points& skin = boundary.obstacles[0].x1;
    const double hem = scene.garment().rest().vertices.col(1).minCoeff();
    for (Eigen::Index i = 0; i < skin.rows(); ++i)
        if (skin(i, 1) < hem - 0.1) skin(i, 1) += 0.8;
    EXPECT_EQ(scene.loss(boundary, scene.garment().rest().vertices), "");
}
