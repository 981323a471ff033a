#include "demos/generalisation/summary.h"

#include <gtest/gtest.h>

#include <cmath>

#include "demos/compare/body_named.h"
#include "demos/compare/body_scene.h"
#include "demos/generalisation/cases.h"

namespace cloth::generalisation_test {

namespace {

SolverRow row(const std::string& solver, double gap, double rollout, bool fails = false) {
    SolverRow row;
    row.solver = solver;
    row.gap_median = gap;
    row.fine_rmse_mm = rollout;
    if (fails) row.first_failed_frame = 3;
    return row;
}

}  // namespace

TEST(GeneralisationSummary, RelativesAreWithinAScene) {
    const auto summaries = summarise(
        "g", {row("base", 0.1, 10), row("net", 0.2, 5), row("base", 1, 40), row("net", 0.5, 80)},
        "base");
    ASSERT_EQ(summaries.size(), 2u);
    EXPECT_EQ(summaries[1].solver, "net");
    EXPECT_EQ(summaries[1].scenes, 2);
    EXPECT_DOUBLE_EQ(summaries[1].gap, 0.35);
    EXPECT_DOUBLE_EQ(summaries[1].rollout_mm, 42.5);
    EXPECT_NEAR(summaries[1].relative_gap, 1.0, 1e-12);      // twice and half
    EXPECT_NEAR(summaries[1].relative_rollout, 1.0, 1e-12);  // half and twice
    EXPECT_NEAR(summaries[0].relative_gap, 1.0, 1e-12);
}

TEST(GeneralisationSummary, LostRolloutsAreCountedNotAveraged) {
    const auto summaries = summarise("g",
                                     {row("base", 0.1, 10), row("net", 0.2, 900, true),
                                      row("base", 0.1, 10), row("net", 0.2, 20)},
                                     "base");
    EXPECT_EQ(summaries[1].failed, 1);
    EXPECT_DOUBLE_EQ(summaries[1].rollout_mm, 20.0);
    EXPECT_NEAR(summaries[1].relative_rollout, 2.0, 1e-12);
    const auto none = summarise("g", {row("base", 0.1, 10), row("net", 0.2, 9, true)}, "base");
    EXPECT_TRUE(std::isnan(none[1].rollout_mm));
    EXPECT_TRUE(to_json(none[1]).at("rollout_mm").is_null());
}

TEST(GeneralisationSummary, GapsNeedAMinimum) {
    const auto summaries = summarise(
        "g", {row("base", 0.1, 10), row("net", 0.2, 5), row("base", 0.7, 10), row("net", -1.4, 5)},
        "base");
    EXPECT_EQ(summaries[1].scenes, 2);
    EXPECT_EQ(summaries[1].gap_scenes, 1);
    EXPECT_DOUBLE_EQ(summaries[0].gap, 0.1);
    EXPECT_NEAR(summaries[1].relative_gap, 2.0, 1e-12);
}

TEST(GeneralisationSummary, SolversOfSmallStepsHaveNoGap) {
    const auto summaries =
        summarise("g", {row("base", 0.1, 10), row("net60+2s60", -0.2, 5)}, "base");
    EXPECT_EQ(summaries[0].gap_scenes, 1);
    EXPECT_EQ(summaries[1].gap_scenes, 0);
    EXPECT_TRUE(std::isnan(summaries[1].gap));
    EXPECT_NEAR(summaries[1].relative_rollout, 0.5, 1e-12);
}

TEST(GeneralisationCases, AllNamesAreThere) {
    for (const CaseGroup& group : generalisation_cases(5)) {
        EXPECT_FALSE(group.scenes.empty()) << group.name;
        for (const SceneSettings& scene : group.scenes) {
            check_garment_name(scene.name);
            body_shape_named(scene.body);
            EXPECT_EQ(scene.frames, 5);
        }
    }
}

}  // namespace cloth::generalisation_test
