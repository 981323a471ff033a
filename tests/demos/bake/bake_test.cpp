#include "demos/bake/bake.h"

#include <gtest/gtest.h>

#include "data/core/paths.h"
#include "data/core/read_file.h"
#include "data/files/cache_format.h"
#include "data/files/mesh_io.h"
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
