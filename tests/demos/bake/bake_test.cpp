#include "demos/bake/bake.h"

#include <gtest/gtest.h>

#include "data/body/body.h"
#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "data/files/cache_format.h"
#include "data/files/mesh_io.h"
#include "data/files/painted_mesh.h"
#include "data/files/point_cache_reader.h"
#include "demos/compare/arguments.h"
#include "demos/compare/solver_factory.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::bake_test {

using namespace test;

namespace {

class Bake : public FileTest {
 protected:
    /// A cape on a person, for six frames.
    BakeOptions cape(const std::string& solver) const {
        BakeOptions options;
        options.character.character = model_path("X/BCN_Epileptic.X");
        options.character.garment = asset_path("garments/cape.obj");
        options.character.pin = {0.39, 1.0};
        options.character.settle = 0.1;
        options.character.steps = 5;
        options.solver = solver;
        options.out = path("cape.pc2");
        options.body = path("person.mdd");
        return options;
    }

    /// Runs until so many frames are written; none: to the end.
    static bool run(const BakeOptions& options, int frames = -1) {
        const BakeScene scene = make_bake_scene(options);
        const auto stepper = make_solver(options.solver, *scene.cloth, {});
        std::vector<BakedMesh> meshes = open_caches(scene, options);
        return bake(scene, *stepper, meshes,
                    {[](int, int, const std::string&) {},
                     [&] { return meshes[0].cache->frames() == frames; }});
    }
};

Points as_floats(const Points& x) {
    return x.cast<float>().cast<double>();
}

/// Fails from the third step on.
class Failing : public Stepper {
 public:
    std::string name() const override { return "failing"; }
    StepReport step(const Boundary&, double, ClothState&) override {
        return ++m_steps < 3 ? StepReport() : StepReport::failed();
    }

 private:
    int m_steps = 0;
};

/// Pulls every other vertex aside, which keeps the garment about where it is.
class Tearing : public Stepper {
 public:
    std::string name() const override { return "tearing"; }
    StepReport step(const Boundary&, double, ClothState& state) override {
        for (Eigen::Index i = 0; i < state.x.rows() && !m_torn; i += 2) state.x(i, 0) += 0.15;
        m_torn = true;
        return {};
    }

 private:
    bool m_torn = false;
};

}  // namespace

TEST_F(Bake, ACacheHoldsTheFramesThatTheSolverGives) {
    const BakeOptions options = cape("quasi-newton");
    ASSERT_TRUE(run(options));
    const BakeScene scene = make_bake_scene(options);
    const auto stepper = make_solver(options.solver, *scene.cloth, {});
    PointCacheReader cloth(options.out), body(options.body);
    ASSERT_EQ(cloth.frames(), 6);
    ASSERT_EQ(body.frames(), 6);
    const double dt = scene.cloth->frame_time();
    ClothState state = scene.cloth->start();
    for (int frame = -scene.cloth->lead_in_frames(); frame < 6; ++frame) {
        if (frame >= 0) {
            EXPECT_EQ(cloth.frame(frame), as_floats(state.x)) << frame;
            EXPECT_EQ(body.frame(frame), as_floats(scene.skin(frame * dt))) << frame;
        }
        stepper->step(scene.cloth->frame_boundary(frame), dt, state);
    }
    EXPECT_GT((cloth.frame(5) - cloth.frame(0)).norm(), 0.01) << "it moved";
    EXPECT_NEAR(body.times()[5], 5.0 / 30.0, 1e-6);
}

TEST_F(Bake, EachCacheHasAMeshFileWithTheSameVertices) {
    const BakeOptions options = cape("xpbd-10");
    ASSERT_TRUE(run(options));
    PointCacheReader(options.out).check_vertices(load_mesh(path("cape_rest.obj")).vertices.rows());
    PointCacheReader(options.body)
        .check_vertices(load_mesh(path("person_rest.obj")).vertices.rows());
    EXPECT_EQ(rest_file("out/shirt.mdd"), "out/shirt_rest.obj");
    EXPECT_EQ(rest_file("out/shirt"), "out/shirt_rest.obj");
    EXPECT_EQ(rest_file("out/shirt/"), "out/shirt_rest.obj");
}

// These solvers remember more than positions and velocities.
TEST_F(Bake, ARunThatIsResumedEqualsOneThatWasNotInterruptedBitForBit) {
    for (const char* solver : {"quasi-newton-bdf2", "xpbd-10"}) {
        BakeOptions options = cape(solver);
        ASSERT_TRUE(run(options));
        const std::string cloth = read_file(options.out), body = read_file(options.body);
        for (const int frames : {0, 1, 4}) {
            SCOPED_TRACE(std::string(solver) + ", interrupted after " + std::to_string(frames));
            std::filesystem::remove(options.out);
            std::filesystem::remove(options.body);
            options.resume = false;
            ASSERT_FALSE(run(options, frames));
            EXPECT_FALSE(std::filesystem::exists(options.out));
            if (frames > 0) {
                const std::string unfinished = unfinished_cache(options.out);
                EXPECT_EQ(PointCacheReader(unfinished).frames(), frames);
                // As if the machine had stopped within a frame.
                std::filesystem::resize_file(unfinished,
                                             std::filesystem::file_size(unfinished) - 7);
            }
            options.resume = true;
            ASSERT_TRUE(run(options));
            EXPECT_EQ(read_file(options.out), cloth);
            EXPECT_EQ(read_file(options.body), body);
        }
    }
}

TEST_F(Bake, ARunIsNotResumedWithOtherOptions) {
    BakeOptions options = cape("xpbd-10");
    ASSERT_FALSE(run(options, 3));
    options.resume = true;
    options.solver = "xpbd-11";
    expect_load_error([&] { run(options); }, unfinished_cache(options.out) + ", frame 0",
                      "differs");
    options.solver = "xpbd-10";
    options.character.steps = 4;
    expect_load_error([&] { run(options); }, unfinished_cache(options.out) + ", header", "differs");
    options.character.steps = 5;
    EXPECT_TRUE(run(options));
    EXPECT_THROW(run(options), UsageError) << "it is whole";
}

/// The cape, held at its upper seam and free to leave the skin by 5 cm.
PaintedMesh painted_cape() {
    PaintedMesh cape{load_mesh(asset_path("garments/cape.obj")), {}, false};
    cape.limits.max_distance.setConstant(cape.mesh.vertices.rows(), 0.05);
    for (Eigen::Index i = 0; i < cape.mesh.vertices.rows(); ++i)
        if (cape.mesh.vertices(i, 1) > 0.39) cape.limits.max_distance[i] = 0.0;
    return cape;
}

TEST_F(Bake, ACharacterThatIsNoSurfaceIsRefusedByItsFile) {
    BakeOptions options = cape("xpbd-10");
    options.character.character = model_path("X/Testwuson.X");
    try {
        make_bake_scene(options);
        FAIL() << "it was taken";
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("Testwuson.X: edge"), std::string::npos)
            << error.what();
    }
}

TEST_F(Bake, ACharacterThatIsInsideOutIsRefusedByItsFile) {
    BakeOptions options;
    TriMesh skin = Body::load_default().rest_mesh();
    skin.faces.col(1).swap(skin.faces.col(2));
    save_obj(path("statue.obj"), skin);
    options.character.character = path("statue.obj");
    options.character.garment = "tshirt_1000";
    try {
        make_bake_scene(options);
        FAIL() << "it was taken";
    } catch (const ArgumentError& error) {
        EXPECT_EQ(std::string(error.what()).find(path("statue.obj") + ": it is inside out"), 0u)
            << error.what();
    }
}

// A cache of the project's body is a file whose animation is one of morph targets.
TEST_F(Bake, MorphTargetsThatAreNotReadAreSaidWithTheFile) {
    const TriMesh skin = Body::load_default().rest_mesh();
    const auto cache = make_cache_writer(path("morphs.glb"), skin, {30.0, 2});
    for (const double up : {0.0, 0.5}) {
        Points x = skin.vertices;
        x.col(1).array() += up;
        cache->add(x);
    }
    cache->finish();
    BakeOptions options;
    options.character.character = path("morphs.glb");
    options.character.garment = "tshirt_1000";
    const BakeScene scene = make_bake_scene(options);
    ASSERT_EQ(scene.notes.size(), 3u);
    EXPECT_EQ(scene.notes[1].find(path("morphs.glb") + ": its animation changes morph targets"), 0u)
        << scene.notes[1];
    EXPECT_NE(scene.notes[2].find("does not move"), std::string::npos);
    EXPECT_EQ(scene.frames(), 90);
}

// The project's body as a file of a mesh and nothing else.
TEST_F(Bake, ACharacterThatDoesNotMoveStandsForAsManyFramesAsAreAskedFor) {
    BakeOptions options;
    save_obj(path("statue.obj"), Body::load_default().rest_mesh());
    options.character.character = path("statue.obj");
    options.character.garment = "tshirt_1000";
    const BakeScene scene = make_bake_scene(options);
    EXPECT_EQ(scene.frames(), 90);
    EXPECT_EQ(scene.skin(0.0), scene.skin(2.0));
    ASSERT_EQ(scene.notes.size(), 2u);
    EXPECT_NE(scene.notes[0].find("it wears tshirt_1000 of the wardrobe"), std::string::npos);
    EXPECT_NE(scene.notes[1].find("statue.obj does not move"), std::string::npos);
    EXPECT_NE(scene.notes[1].find("it stands for 90 frames"), std::string::npos);
    options.character.steps = 199;
    EXPECT_EQ(make_bake_scene(options).frames(), 200);
}

TEST_F(Bake, AGarmentThatFallsOffIsToldOnce) {
    BakeOptions options = cape("xpbd-10");
    options.character.pin.clear();
    options.character.settle = 1.0;  // free fall takes it far
    const BakeScene scene = make_bake_scene(options);
    const auto stepper = make_solver(options.solver, *scene.cloth, {});
    std::vector<BakedMesh> meshes = open_caches(scene, options);
    std::vector<std::string> told;
    ASSERT_TRUE(bake(scene, *stepper, meshes,
                     {[](int, int, const std::string&) {}, [] { return false; },
                      [&](int, const std::string& problem) { told.push_back(problem); }}));
    ASSERT_EQ(told.size(), 1u);
    EXPECT_NE(told[0].find("slid off: it is "), std::string::npos) << told[0];
}

TEST_F(Bake, AGarmentThatIsTornAtTheEndIsTold) {
    const BakeOptions options = cape("xpbd-10");
    const BakeScene scene = make_bake_scene(options);
    const auto told = [&](Stepper& stepper) {
        std::vector<BakedMesh> meshes = open_caches(scene, options);
        std::vector<std::pair<int, std::string>> problems;
        EXPECT_TRUE(bake(scene, stepper, meshes,
                         {[](int, int, const std::string&) {}, [] { return false; },
                          [&](int frame, const std::string& problem) {
                              problems.emplace_back(frame, problem);
                          }}));
        return problems;
    };
    Tearing tearing;
    const auto problems = told(tearing);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].first, 5);
    EXPECT_EQ(problems[0].second, "the garment is lost: it failed, fell off or was torn");
    EXPECT_TRUE(told(*make_solver(options.solver, *scene.cloth, {})).empty()) << "it is worn";
}

TEST_F(Bake, FilesThatAreJoinedByPlusAreWornInLayers) {
    BakeOptions options = cape("quasi-newton");
    const TriMesh inner = load_mesh(options.character.garment);
    TriMesh outer = inner;
    outer.vertices += 0.01 * vertex_normals(inner.vertices, inner.faces);
    save_obj(path("outer.obj"), outer);
    options.character.garment = path("outer.obj") + "+" + options.character.garment;
    const BakeScene scene = make_bake_scene(options);
    EXPECT_TRUE(scene.cloth->self_contact().on());
    ASSERT_EQ(scene.parts.size(), 2u);
    EXPECT_EQ(scene.parts[0], outer.faces);
    EXPECT_EQ(scene.parts[1], Faces(inner.faces.array() + static_cast<int>(outer.vertices.rows())));
    EXPECT_EQ(scene.cloth->garment().vertex_count(), 2 * inner.vertices.rows());
    EXPECT_EQ(scene.cloth->garment().pins().size() % 2, 0u)
        << "both are pinned at their upper edge";
    const auto stepper = make_solver(options.solver, *scene.cloth, {});
    ClothState state = scene.cloth->start();
    const Boundary boundary = scene.cloth->frame_boundary(-scene.cloth->lead_in_frames());
    EXPECT_TRUE(stepper->step(boundary, scene.cloth->frame_time(), state).finite);
    EXPECT_EQ(scene.cloth->loss(boundary, state.x), "");
    state.x.bottomRows(inner.vertices.rows()).col(1).array() -= 0.4;
    const std::string lost = scene.cloth->loss(boundary, state.x);
    EXPECT_EQ(lost.find("piece 2 of 2 came off the body"), 0u) << lost;
}

TEST_F(Bake, MessagesNameTheGarmentsFile) {
    BakeOptions options = cape("xpbd-10");
    TriMesh fin = load_mesh(options.character.garment);
    const int a = fin.faces(0, 0), b = fin.faces(0, 1);
    fin.vertices.conservativeResize(fin.vertices.rows() + 2, 3);
    fin.faces.conservativeResize(fin.faces.rows() + 2, 3);
    for (const int k : {1, 2}) {
        const Eigen::Index tip = fin.vertices.rows() - k;
        fin.vertices.row(tip) = fin.vertices.row(a) + Eigen::RowVector3d(0.01 * k, 0.05, 0.0);
        fin.faces.row(fin.faces.rows() - k) << a, b, static_cast<int>(tip);
    }
    save_obj(path("fin.obj"), fin);
    TriMesh away = load_mesh(options.character.garment);
    away.vertices.col(2).array() += 3.0;
    save_obj(path("away.obj"), away);
    for (const auto& [file, problem] :
         std::vector<std::pair<std::string, std::string>>{{"fin.obj", ": edge "},
                                                          {"away.obj", ": it is "},
                                                          {"none.obj", ": there is no such"}}) {
        options.character.garment = asset_path("garments/cape.obj") + "+" + path(file);
        try {
            make_bake_scene(options);
            ADD_FAILURE() << file << " was taken";
        } catch (const std::exception& error) {
            EXPECT_EQ(std::string(error.what()).rfind(path(file) + problem, 0), 0u) << error.what();
        }
    }
}

TEST_F(Bake, WhatWasModelledFlatIsNotLostWhenItHangs) {
    const BakeScene scene = make_bake_scene(cape("xpbd-10"));
    const Boundary boundary = scene.cloth->frame_boundary(-scene.cloth->lead_in_frames());
    const Points worn = scene.cloth->start().x;
    Points hanging = worn;
    const double top = hanging.col(1).maxCoeff();
    hanging.col(1) = (top - 3.0 * (top - hanging.col(1).array())).matrix();
    ASSERT_LT(hanging.col(1).mean(), worn.col(1).mean() - 0.3);
    EXPECT_EQ(scene.cloth->loss(boundary, hanging), "");
    hanging.col(1).array() -= 0.5;
    EXPECT_NE(scene.cloth->loss(boundary, hanging), "");
}

TEST_F(Bake, GoalsThatArePaintedInTheFileHoldTheGarmentNearTheSkin) {
    BakeOptions options = cape("quasi-newton");
    const PaintedMesh painted = painted_cape();
    save_painted_ply(path("cape.ply"), painted.mesh, painted.limits);
    options.character.garment = path("cape.ply");
    options.character.pin.clear();
    const BakeScene scene = make_bake_scene(options);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find(std::to_string(painted.mesh.vertices.rows()) +
                                  " of its vertices have a largest distance, 0 a backstop"),
              std::string::npos)
        << scene.notes[0];
    const auto stepper = make_solver(options.solver, *scene.cloth, {});
    const Garment& garment = scene.cloth->garment();
    ClothState state = scene.cloth->start();
    double farthest = 0.0;
    for (int frame = -scene.cloth->lead_in_frames(); frame < 6; ++frame) {
        const Boundary boundary = scene.cloth->frame_boundary(frame);
        const StepReport report = stepper->step(boundary, scene.cloth->frame_time(), state);
        ASSERT_TRUE(report.finite);
        const VectorX away = (state.x - boundary.goals.x1).rowwise().norm();
        if (report.vertices_beyond_goals == 0) {
            EXPECT_LE((away - garment.goal_limits().max_distance).maxCoeff(), 1e-9) << frame;
        }
        EXPECT_LT(report.max_goal_excess, 0.01) << "what skin that bends leaves";
        farthest = std::max(farthest, away.maxCoeff());
    }
    EXPECT_GT(farthest, 0.005) << "it is cloth";
}

TEST_F(Bake, ColoursAreReadAsGoalsIfAskedForAndNamedIfNot) {
    BakeOptions options = cape("quasi-newton");
    const TriMesh mesh = load_mesh(asset_path("garments/cape.obj"));
    std::string text;
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        for (int c = 0; c < 3; ++c) text += (c ? " " : "v ") + std::to_string(mesh.vertices(i, c));
        text += mesh.vertices(i, 1) > 0.39 ? " 0 1 1\n" : " 0.5 1 1\n";
    }
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int c = 0; c < 3; ++c)
            text += (c ? " " : "f ") + std::to_string(mesh.faces(f, c) + 1) + (c == 2 ? "\n" : "");
    options.character.garment = write("coloured.obj", text);
    const BakeScene unread = make_bake_scene(options);
    EXPECT_FALSE(unread.cloth->garment().has_goals());
    ASSERT_EQ(unread.notes.size(), 1u);
    EXPECT_NE(unread.notes[0].find("--goal-colours"), std::string::npos);
    options.character.goal_colours.emplace().max_distance = 0.3;
    const BakeScene read = make_bake_scene(options);
    const VectorX& limits = read.cloth->garment().goal_limits().max_distance;
    EXPECT_NEAR(limits.maxCoeff(), 0.15, 1e-6);
    EXPECT_EQ(limits.minCoeff(), 0.0);
    EXPECT_EQ(read.cloth->frame_boundary(0).goals.x1.rows(), limits.size());
    options.character.garment = asset_path("garments/cape.obj");
    try {
        make_bake_scene(options);
        FAIL() << "it has no colours";
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("cape.obj: it has no vertex colours"),
                  std::string::npos)
            << error.what();
    }
    options.character.garment += "+" + path("coloured.obj");
    EXPECT_TRUE(make_bake_scene(options).cloth->garment().has_goals()) << "one of them has some";
}

TEST_F(Bake, AStepThatFailsEndsTheRunAndLeavesWhatIsThere) {
    const BakeOptions options = cape("xpbd-10");
    const BakeScene scene = make_bake_scene(options);
    ASSERT_EQ(scene.cloth->lead_in_frames(), 3);
    std::vector<BakedMesh> meshes = open_caches(scene, options);
    Failing stepper;
    EXPECT_THROW(
        bake(scene, stepper, meshes, {[](int, int, const std::string&) {}, [] { return false; }}),
        std::runtime_error);
    EXPECT_FALSE(std::filesystem::exists(options.out));
    EXPECT_TRUE(std::filesystem::exists(unfinished_cache(options.out)));
}

TEST_F(Bake, TheProjectsBodyIsBakedWithItsGarment) {
    BakeOptions options;
    options.garment = "tshirt_1000";
    options.motion = "01_01";
    options.frames = 2;
    options.rate = 10;
    options.solver = "xpbd-10";
    options.out = path("shirt");
    options.body = path("body.usda");
    ASSERT_TRUE(run(options));
    EXPECT_TRUE(load_mesh(path("shirt/shirt_0002.obj")).vertices.allFinite());
    EXPECT_FALSE(std::filesystem::exists(path("shirt/shirt_0003.obj")));
    EXPECT_NE(read_file(path("body.usda")).find("endTimeCode = 1\n"), std::string::npos);
}

}  // namespace cloth::bake_test
