#include "demos/compare/body_scene.h"

#include <gtest/gtest.h>

#include "collision/self/self_tangles.h"
#include "data/files/garment_assets.h"
#include "demos/compare/arguments.h"
#include "demos/compare/solver_factory.h"

namespace cloth::body_scene_test {

namespace {

BodySceneSettings small_shirt() {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000";
    return settings;
}

}  // namespace

TEST(BodySceneLoss, AShirtInPlaceBelongsToTheScene) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * scene.frame_time();
    EXPECT_EQ(scene.loss(scene.boundary(start, start), scene.garment().rest().vertices), "");
}

TEST(BodySceneLoss, AShirtThatFellToTheFeetOrStayedBehindDoesNot) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * scene.frame_time();
    Points x = scene.garment().rest().vertices;
    x.col(1).array() -= 0.5;
    EXPECT_EQ(scene.loss(scene.boundary(start, start), x), "slid off the body");
    Boundary gone = scene.boundary(start, start);
    gone.obstacles[0].x1.col(0).array() += 1.0;
    EXPECT_EQ(scene.loss(gone, scene.garment().rest().vertices), "slid off the body");
}

TEST(BodyScene, GarmentsWithAWaistbandStartAsTheyAreWorn) {
    BodySceneSettings settings;
    settings.garment = "pants_1000";
    const BodyScene scene(settings);
    const ClothState start = scene.start();
    EXPECT_EQ(start.x, load_garment_start("pants_1000").x);
    EXPECT_NE(start.x, scene.garment().rest().vertices);
    EXPECT_EQ(start.v.norm(), 0.0);
    const double time = -scene.lead_in_frames() * scene.frame_time();
    EXPECT_EQ(scene.loss(scene.boundary(time, time), start.x), "");
}

TEST(BodyScene, AHigherRateIsTheSameMotionInSmallerSteps) {
    BodySceneSettings settings = small_shirt();
    const BodyScene slow(settings);
    settings.rate = 60;
    const BodyScene fast(settings);
    EXPECT_EQ(fast.frame_time(), 1.0 / 60.0);
    EXPECT_EQ(fast.lead_in_frames(), 2 * slow.lead_in_frames());
    const Boundary whole = slow.frame_boundary(7), last_half = fast.frame_boundary(15);
    const Points &end = whole.obstacles[0].x1, &same = last_half.obstacles[0].x1;
    EXPECT_LT((end - same).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT((whole.obstacles[0].x0 - last_half.obstacles[0].x0).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(BodyScene, LayersOfAnOutfitKeepOffEachOther) {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000+pants_1000";
    const BodyScene scene(settings);
    EXPECT_GT(scene.self_contact().thickness, 0.0);
    EXPECT_FALSE(BodyScene(small_shirt()).self_contact().on());
    const SolverSettings solvers;
    const auto stepper = make_solver("quasi-newton-10", scene, solvers);
    SelfTangles tangles(scene.garment());
    ClothState state = scene.start();
    const int first = -scene.lead_in_frames();
    for (int frame = first; frame < first + 12; ++frame) {
        EXPECT_EQ(tangles.find(state.x).size(), 0u) << "frame " << frame;
        const StepReport report = stepper->step(
            scene.boundary(frame * scene.frame_time(), (frame + 1) * scene.frame_time()),
            scene.frame_time(), state);
        EXPECT_TRUE(report.finite);
        EXPECT_LT(report.max_penetration, 1e-3);
    }
}

TEST(BodyScene, AWrongGarmentIsAnsweredWithTheRightOnes) {
    EXPECT_THROW(check_garment_name("tshirt+toga"), UsageError);
    check_garment_name("tshirt+pants");

    try {
        check_garment_name("toga");
        FAIL() << "there is no toga";
    } catch (const UsageError& error) {
        const std::string text = error.what();
        for (const char* part : {"toga", "pants_1000", "tshirt"})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

// Sitting moves the mean of the whole body by more than that of the torso.
TEST(BodySceneLoss, LegsThatMoveAloneDoNotCount) {
    const BodyScene scene(small_shirt());
    const double start = -scene.lead_in_frames() * scene.frame_time();
    Boundary boundary = scene.boundary(start, start);
    Points& skin = boundary.obstacles[0].x1;
    const double hem = scene.garment().rest().vertices.col(1).minCoeff();
    for (Eigen::Index i = 0; i < skin.rows(); ++i)
        if (skin(i, 1) < hem - 0.1) skin(i, 2) += 0.8;
    EXPECT_EQ(scene.loss(boundary, scene.garment().rest().vertices), "");
}

}  // namespace cloth::body_scene_test
