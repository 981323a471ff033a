#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "demos/compare/arguments.h"
#include "demos/scaling/options.h"
#include "demos/scaling/scaling_run.h"

namespace cloth::scaling_test {
namespace {

std::string message(const std::vector<std::string>& arguments) {
    try {
        parse_scaling_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

Rollout rollout_of(const std::vector<double>& ms) {
    Rollout rollout;
    rollout.ms = rollout.proximity = rollout.features = rollout.solve = rollout.contact = ms;
    return rollout;
}

}  // namespace

TEST(Scaling, OptionsOutOfRangeAreRefused) {
    EXPECT_NE(message({"--scenes", "toga"}).find("sphere"), std::string::npos);
    EXPECT_NE(message({"--vertices", "1000,70000"}).find("60000"), std::string::npos);
    EXPECT_NE(message({"--frames", "0"}).find("--frames"), std::string::npos);
    const ScalingOptions options = parse_scaling_options({"--vertices", "1000,2000"});
    EXPECT_EQ(options.vertices, (std::vector<int>{1000, 2000}));
    EXPECT_EQ(options.scenes, (std::vector<std::string>{"sphere", "dress"}));
}

TEST(Scaling, FramesOfTheWarmUpDoNotCount) {
    const ScalingRow row = make_scaling_row(rollout_of({100, 90, 1, 2, 3}), 2);
    EXPECT_EQ(row.frames, 3);
    EXPECT_EQ(row.ms_median, 2.0);
    EXPECT_EQ(row.contact_ms, 2.0);
    EXPECT_EQ(make_scaling_row(rollout_of({100}), 2).frames, 0);
}

TEST(Scaling, GarmentsHaveAboutTheVerticesThatWereAskedFor) {
    const std::string work = testing::TempDir() + "scaling_garments";
    for (const std::string& scene : scaling_scenes())
        for (const int vertices : {700, 1500}) {
            const auto made = make_sized_scene({scene, vertices, 2, work});
            EXPECT_NEAR(static_cast<double>(made->garment().vertex_count()), vertices,
                        0.03 * vertices)
                << scene;
        }
    std::filesystem::remove_all(work);
}

TEST(Scaling, EachSolverOfASizeHasARow) {
    ScalingSettings settings;
    settings.solvers = {"quasi-newton-3", "xpbd-20"};
    settings.warm_up = 1;
    const std::vector<ScalingRow> rows =
        measure_size({"sphere", 500, 3, ""}, settings, [](int, int, const std::string&) {});
    ASSERT_EQ(rows.size(), 2u);
    for (size_t k = 0; k < rows.size(); ++k) {
        EXPECT_EQ(rows[k].solver, settings.solvers[k]);
        EXPECT_EQ(rows[k].frames, 2);
        EXPECT_GT(rows[k].ms_median, 0.0);
        EXPECT_GT(rows[k].setup_ms, 0.0);
        EXPECT_TRUE(rows[k].failure.empty()) << rows[k].failure;
    }
    const std::string plot = scaling_plot(rows, 2);
    EXPECT_NE(plot.find("xpbd-20"), std::string::npos);
}

}  // namespace cloth::scaling_test
