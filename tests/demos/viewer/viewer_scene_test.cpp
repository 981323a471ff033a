#include "demos/viewer/viewer_scene.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "data/body/body.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "demos/compare/solver_factory.h"

namespace cloth::viewer_scene_test {

namespace {

SceneOptions shirt(const std::string& solver = "xpbd-10") {
    SceneOptions options;
    options.garment = "tshirt_1000";
    options.motion = "01_01";
    options.solver = solver;
    return options;
}

void advance(ViewerScene& scene, const ViewerControls& controls, int steps) {
    for (int k = 0; k < steps; ++k) scene.advance(controls);
}

/// The lowest vertex of the garment in front: it hangs free.
int hem_vertex(const ViewerFrame& frame) {
    int lowest = 0;
    for (int i = 0; i < frame.cloth.rows(); ++i) {
        const double middle = frame.cloth.col(2).mean();
        if (frame.cloth(i, 2) > middle && frame.cloth(i, 1) < frame.cloth(lowest, 1)) lowest = i;
    }
    return lowest;
}

double largest_way(const Points& a, const Points& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

}  // namespace

TEST(ViewerScene, StartsAsWornAndPlaysIntoTheMotion) {
    ViewerScene scene(shirt());
    EXPECT_LT(scene.frame().frame, 0);
    EXPECT_EQ(scene.frame().steps, 0);
    const ViewerFrame before = scene.frame();
    const ViewerControls controls = scene.controls();
    EXPECT_TRUE(scene.advance(controls));
    EXPECT_EQ(scene.frame().frame, before.frame + 1);
    EXPECT_EQ(scene.frame().steps, 1);
    EXPECT_GT(largest_way(scene.frame().cloth, before.cloth), 1e-4);
    EXPECT_GT(largest_way(scene.frame().skin, before.skin), 1e-4);
    EXPECT_GT(scene.frame().ms, 0.0);
    EXPECT_EQ(scene.frame().solver, "xpbd-10");
    EXPECT_GT(scene.frame().stretch.max, 1.0);
}

TEST(ViewerScene, PauseStopsItAndASingleStepIsOne) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    advance(scene, controls, 3);
    const ViewerFrame before = scene.frame();
    controls.playing = false;
    for (int k = 0; k < 3; ++k) EXPECT_FALSE(scene.advance(controls));
    EXPECT_EQ(scene.frame().steps, before.steps);
    EXPECT_TRUE(same_points(scene.frame().cloth, before.cloth));
    ++controls.single_steps;
    EXPECT_TRUE(scene.advance(controls));
    EXPECT_FALSE(scene.advance(controls));
    EXPECT_EQ(scene.frame().steps, before.steps + 1);
}

TEST(ViewerScene, ARestartGivesTheSameBits) {
    for (const char* solver : {"xpbd-10", "quasi-newton"}) {
        ViewerScene scene(shirt(solver));
        ViewerControls controls = scene.controls();
        advance(scene, controls, 6);
        const ViewerFrame first = scene.frame();
        advance(scene, controls, 3);
        ++controls.restarts;
        EXPECT_FALSE(scene.advance(controls)) << "the start is shown";
        EXPECT_EQ(scene.frame().steps, 0);
        advance(scene, controls, 6);
        EXPECT_TRUE(same_points(scene.frame().cloth, first.cloth)) << solver;
        EXPECT_EQ(scene.frame().frame, first.frame);
    }
}

// Bake's loop is another one, over the same scene.
TEST(ViewerScene, StepsAreThoseOfTheSolverAlone) {
    const SceneOptions options = shirt("quasi-newton");
    ViewerScene scene(options);
    const ViewerControls controls = scene.controls();
    const BakeScene alone = make_bake_scene(options);
    const auto stepper = make_solver(options.solver, *alone.cloth, {});
    ClothState state = alone.cloth->start();
    for (int k = 0; k < 6; ++k) {
        scene.advance(controls);
        stepper->step(alone.cloth->frame_boundary(k - alone.cloth->lead_in_frames()),
                      alone.cloth->frame_time(), state);
    }
    EXPECT_TRUE(same_points(scene.state().x, state.x));
    EXPECT_TRUE(same_points(scene.frame().skin,
                            alone.skin(scene.frame().frame * alone.cloth->frame_time())));
}

TEST(ViewerScene, ASolverIsSwitchedWithoutAJumpOfTheState) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    advance(scene, controls, 8);
    for (const char* solver : {"quasi-newton", "small", "small+3", "quasi-newton-5", "xpbd-20"}) {
        const ClothState before = scene.state();
        controls.solver = solver;
        controls.playing = false;
        scene.advance(controls);
        EXPECT_TRUE(same_points(scene.state().x, before.x)) << solver;
        EXPECT_TRUE(same_points(scene.state().v, before.v)) << solver;
        controls.playing = true;
        scene.advance(controls);
        EXPECT_EQ(scene.frame().refusal, "");
        EXPECT_EQ(scene.frame().solver, solver);
        EXPECT_TRUE(scene.frame().report.finite) << solver;
        // the cloth goes on as it moved
        const Points straight = before.x + scene.frame_time() * before.v;
        EXPECT_LT(largest_way(scene.state().x, straight), 0.05) << solver;
        EXPECT_LT(scene.frame().stretch.max, 2.0) << solver;
    }
}

TEST(ViewerScene, WhatCannotBeFollowedIsRefusedAndAllGoesOn) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    advance(scene, controls, 2);
    controls.solver = "nonsense";
    EXPECT_TRUE(scene.advance(controls));
    EXPECT_NE(scene.frame().refusal.find("nonsense"), std::string::npos);
    EXPECT_EQ(scene.frame().solver, "xpbd-10");
    controls.solver = "xpbd-20";
    scene.advance(controls);
    EXPECT_EQ(scene.frame().refusal, "");
    EXPECT_EQ(scene.frame().solver, "xpbd-20");
    controls.fabric.mu = 1e7;
    scene.advance(controls);
    EXPECT_NE(scene.frame().refusal.find("mu"), std::string::npos) << scene.frame().refusal;
    EXPECT_EQ(scene.garment().fabric().mu, Fabric::soft_cotton().mu);
    controls.wind.speed = -1.0;
    EXPECT_TRUE(scene.advance(controls));
    EXPECT_NE(scene.frame().refusal.find("WindSettings.speed"), std::string::npos);
    ++controls.restarts;
    scene.advance(controls);
    EXPECT_EQ(scene.frame().steps, 0) << "a restart is not refused with the rest";
}

TEST(ViewerScene, AnotherFabricKeepsTheState) {
    ViewerScene scene(shirt("quasi-newton"));
    ViewerControls controls = scene.controls();
    advance(scene, controls, 40);
    const double soft = scene.frame().stretch.p99;
    const ClothState before = scene.state();
    controls.playing = false;
    controls.fabric = Fabric::real_cotton();
    scene.advance(controls);
    EXPECT_TRUE(same_points(scene.state().x, before.x));
    EXPECT_EQ(scene.garment().fabric().mu, Fabric::real_cotton().mu);
    controls.playing = true;
    advance(scene, controls, 10);
    EXPECT_LT(scene.frame().stretch.p99, soft);
    EXPECT_LT(scene.frame().stretch.p99, 1.1) << "it is 150 times as stiff";
}

TEST(ViewerScene, DraggedClothComesAlongAndIsReleased) {
    for (const char* solver : {"quasi-newton", "xpbd-20", "small+3"}) {
        SCOPED_TRACE(solver);
        ViewerScene scene(shirt(solver));
        ViewerControls controls = scene.controls();
        controls.body_moves = false;
        advance(scene, controls, 15);
        const int vertex = hem_vertex(scene.frame());
        const Vec3 place = scene.state().x.row(vertex).transpose();
        const Vec3 target = place + Vec3(0, 0.05, 0.2);
        const Points hanging = scene.state().x;

        controls.playing = false;
        controls.pull = ViewerControls::Pull{vertex, target};
        scene.advance(controls);
        EXPECT_TRUE(scene.frame().is_pulled);
        EXPECT_TRUE(same_points(scene.state().x, hanging)) << "a grip moves nothing by itself";
        controls.playing = true;
        double way = (place - target).norm();
        for (int step = 0; step < 20; ++step) {
            const Points before = scene.state().x;
            scene.advance(controls);
            EXPECT_LT(largest_way(scene.state().x, before), 0.16) << "no farther than the pull";
        }
        const Vec3 pulled = scene.state().x.row(vertex).transpose();
        EXPECT_LT((pulled - target).norm(), 0.6 * way);
        EXPECT_LT(scene.frame().stretch.max, 2.5);

        controls.pull.reset();
        scene.advance(controls);
        EXPECT_FALSE(scene.frame().is_pulled);
        advance(scene, controls, 40);
        const Vec3 released = scene.state().x.row(vertex).transpose();
        EXPECT_LT((released - place).norm(), 0.6 * (pulled - place).norm()) << "it falls back";
        EXPECT_TRUE(scene.frame().report.finite);
    }
}

TEST(ViewerScene, AReleasedGripLeavesNoForce) {
    ViewerScene gripped(shirt("quasi-newton")), free(shirt("quasi-newton"));
    ViewerControls controls = gripped.controls();
    advance(gripped, controls, 5);
    advance(free, controls, 5);
    controls.playing = false;
    controls.pull = ViewerControls::Pull{10, Vec3(0, 3, 0)};
    gripped.advance(controls);
    controls.pull.reset();
    gripped.advance(controls);
    controls.playing = true;
    advance(gripped, controls, 3);
    advance(free, controls, 3);
    EXPECT_TRUE(same_points(gripped.state().x, free.state().x));
}

TEST(ViewerScene, TheSolverCanBeSwitchedWhileClothIsHeld) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    advance(scene, controls, 3);
    const int vertex = hem_vertex(scene.frame());
    controls.pull =
        ViewerControls::Pull{vertex, scene.state().x.row(vertex).transpose() + Vec3(0, 0, 0.1)};
    advance(scene, controls, 2);
    controls.solver = "quasi-newton";
    advance(scene, controls, 2);
    EXPECT_TRUE(scene.frame().is_pulled);
    EXPECT_EQ(scene.frame().solver, "quasi-newton");
    controls.pull->vertex = 100000;
    scene.advance(controls);
    EXPECT_FALSE(scene.frame().is_pulled);
    EXPECT_NE(scene.frame().refusal.find("vertex"), std::string::npos);
}

TEST(ViewerScene, BulletsOwnClothCannotBeDragged) {
    ViewerScene scene(shirt("bullet"));
    ViewerControls controls = scene.controls();
    controls.pull = ViewerControls::Pull{0, Vec3(0, 1, 0)};
    EXPECT_TRUE(scene.advance(controls));
    EXPECT_NE(scene.frame().refusal.find("dragged"), std::string::npos);
}

TEST(ViewerScene, WindBlowsTheCloth) {
    ViewerScene calm(shirt()), windy(shirt());
    ViewerControls controls = calm.controls();
    controls.body_moves = false;
    advance(calm, controls, 20);
    controls.wind.speed = 8.0;
    controls.wind.gusts = 0.0;
    advance(windy, controls, 20);
    const double push = (windy.state().x - calm.state().x).col(2).mean();
    EXPECT_GT(push, 5e-3) << "along z";
}

TEST(ViewerScene, ABodyThatDoesNotMoveHoldsItsPose) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    controls.body_moves = false;
    const ViewerFrame before = scene.frame();
    advance(scene, controls, 4);
    EXPECT_TRUE(same_points(scene.frame().skin, before.skin));
    EXPECT_EQ(scene.frame().frame, before.frame);
    EXPECT_EQ(scene.frame().steps, 4);
    EXPECT_GT(largest_way(scene.frame().cloth, before.cloth), 1e-4);
}

TEST(ViewerScene, AfterTheMotionTheBodyStandsAndTheClothGoesOn) {
    SceneOptions options = shirt();
    options.frames = 4;
    ViewerScene scene(options);
    const int lead_in = -scene.frame().frame;
    const ViewerControls controls = scene.controls();
    advance(scene, controls, lead_in + 6);
    EXPECT_EQ(scene.frame().frame, scene.frames());
    EXPECT_EQ(scene.frame().steps, lead_in + 6);
    const Points skin = scene.frame().skin;
    scene.advance(controls);
    EXPECT_TRUE(same_points(scene.frame().skin, skin));
}

TEST(ViewerScene, ColoursAreMadeWhereTheyAreAskedFor) {
    ViewerScene scene(shirt());
    ViewerControls controls = scene.controls();
    controls.playing = false;
    EXPECT_EQ(scene.frame().colours.rows(), 0);
    Points last;
    for (const ColourMode mode : {ColourMode::stretch, ColourMode::contact}) {
        controls.colours = mode;
        scene.advance(controls);
        ASSERT_EQ(scene.frame().colours.rows(), scene.garment().vertex_count());
        EXPECT_FALSE(same_points(scene.frame().colours, last));
        last = scene.frame().colours;
    }
}

TEST(ViewerScene, OutfitsHaveAPartForEachGarment) {
    SceneOptions options = shirt();
    options.garment = "tshirt_1000+pants_1000";
    ViewerScene scene(options);
    ASSERT_EQ(scene.parts().size(), 2u);
    EXPECT_EQ(scene.parts()[0].rows() + scene.parts()[1].rows(), scene.garment_faces().rows());
    EXPECT_TRUE(scene.frame().counts_tangles);
    scene.advance(scene.controls());
    EXPECT_TRUE(scene.frame().report.finite);
}

TEST(ViewerScene, CharactersFromFilesAreWornToo) {
    SceneOptions options;
    options.character.character = model_path("X/BCN_Epileptic.X");
    options.character.garment = asset_path("garments/cape.obj");
    options.character.pin = {0.39, 1.0};
    options.character.settle = 0.1;
    options.solver = "quasi-newton";
    ViewerScene scene(options);
    ASSERT_EQ(scene.parts().size(), 1u);
    const ViewerFrame before = scene.frame();
    ViewerControls controls = scene.controls();
    advance(scene, controls, 6);
    EXPECT_GT(largest_way(scene.frame().skin, before.skin), 1e-4);
    EXPECT_TRUE(scene.frame().report.finite);
    controls.fabric = Fabric::real_cotton();
    controls.solver = "xpbd-20";
    advance(scene, controls, 2);
    EXPECT_TRUE(scene.frame().report.finite);
    EXPECT_EQ(scene.frame().refusal, "");
}

TEST(ViewerScene, ACharacterThatIsInsideOutIsRefused) {
    const std::string file = testing::TempDir() + "viewer_inside_out.obj";
    TriMesh skin = Body::load_default().rest_mesh();
    skin.faces.col(1).swap(skin.faces.col(2));
    save_obj(file, skin);
    SceneOptions options;
    options.character.character = file;
    options.character.garment = "tshirt_1000";
    EXPECT_THROW(ViewerScene scene(options), ArgumentError);
    std::filesystem::remove(file);
}

}  // namespace cloth::viewer_scene_test
