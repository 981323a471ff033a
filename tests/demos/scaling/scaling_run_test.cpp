#include "demos/scaling/scaling_run.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "demos/compare/arguments.h"

namespace cloth::scaling_run_test {

namespace {

const auto quiet = [](int, int, const std::string&) {};

std::string fresh_folder(const std::string& name) {
    std::filesystem::path folder = ::testing::TempDir() + name;
    std::filesystem::remove_all(folder);
    return folder.string();
}

}  // namespace

TEST(SizedScene, HasAsManyVerticesAsAreAskedFor) {
    const std::string work = fresh_folder("scaling_sizes");
    for (const std::string& name : scaling_scenes())
        for (const int vertices : {700, 1500}) {
            const auto scene = make_sized_scene({name, vertices, 3, work});
            EXPECT_NEAR(static_cast<double>(scene->garment().vertex_count()), vertices,
                        0.03 * vertices)
                << name;
            EXPECT_EQ(scene->frames(), 3);
            EXPECT_EQ(scene->frame_boundary(0).obstacles.size(), 1U);
        }
}

TEST(SizedScene, AGarmentIsMadeOnce) {
    const std::string work = fresh_folder("scaling_once");
    const auto scene = make_sized_scene({"dress", 600, 1, work});
    const auto file = std::filesystem::directory_iterator(work)->path();
    const auto time = std::filesystem::last_write_time(file);
    const auto again = make_sized_scene({"dress", 600, 1, work});
    EXPECT_EQ(std::filesystem::last_write_time(file), time);
    EXPECT_EQ(again->garment().rest().vertices, scene->garment().rest().vertices);
    EXPECT_THROW(make_sized_scene({"moon", 600, 1, work}), UsageError);
}

TEST(ScalingRun, EverySolverGivesARowOfSense) {
    ScalingSettings settings;
    settings.solvers = {"quasi-newton-3", "small+1", "xpbd-10"};
    settings.warm_up = 1;
    const std::vector<ScalingRow> rows = measure_size({"sphere", 500, 4, ""}, settings, quiet);
    ASSERT_EQ(rows.size(), 3U);
    for (size_t k = 0; k < rows.size(); ++k) {
        const ScalingRow& row = rows[k];
        EXPECT_EQ(row.solver, settings.solvers[k]);
        EXPECT_EQ(row.scene, "sphere");
        EXPECT_EQ(row.frames, 3);
        EXPECT_GT(row.ms_median, 0.0);
        EXPECT_GE(row.ms_p95, row.ms_median);
        EXPECT_NEAR(row.us_per_vertex() * row.vertices, 1e3 * row.ms_median, 1e-6);
        EXPECT_GT(row.solve_ms, 0.0);
        EXPECT_GT(row.setup_ms, 0.0);
        EXPECT_GE(row.memory_mb, 0.0);
        EXPECT_TRUE(to_json(row).at("failure").is_null());
    }
    settings.solvers = {"bulet"};
    EXPECT_THROW(measure_size({"sphere", 500, 4, ""}, settings, quiet), UsageError);
}

TEST(ScalingRow, WarmUpDoesNotCount) {
    Rollout rollout;
    rollout.ms = {100, 90, 1, 2, 3};
    rollout.solve = {50, 40, 1, 1, 1};
    const ScalingRow row = make_scaling_row(rollout, 2);
    EXPECT_EQ(row.frames, 3);
    EXPECT_EQ(row.ms_median, 2.0);
    EXPECT_EQ(row.solve_ms, 1.0);
    EXPECT_EQ(make_scaling_row(rollout, 9).frames, 0) << "it failed in the warm-up";
}

TEST(ScalingPlot, HasALineForEachSceneAndSolver) {
    std::vector<ScalingRow> rows;
    for (const char* scene : {"sphere", "dress"})
        for (const int vertices : {1000, 2000})
            for (const char* solver : {"a+b", "c"}) {
                ScalingRow row;
                row.scene = scene;
                row.solver = solver;
                row.vertices = vertices;
                row.ms_median = 3.0;
                rows.push_back(row);
            }
    const std::string svg = scaling_plot(rows, 2);
    for (const char* line : {"sphere: a+b", "sphere: c", "dress: a+b", "dress: c", "2 threads"})
        EXPECT_NE(svg.find(line), std::string::npos) << line;
}

}  // namespace cloth::scaling_run_test
