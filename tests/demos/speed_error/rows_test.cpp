#include <gtest/gtest.h>

#include <sstream>

#include "demos/speed_error/plots.h"
#include "demos/speed_error/solver_row.h"

namespace cloth::rows_test {

namespace {

SolverRow row_named(const std::string& solver, double ms, double error) {
    SolverRow row;
    row.scene = "sheet";
    row.fabric = "soft";
    row.solver = solver;
    row.ms_median = ms;
    row.gap_median = row.progress_median = row.rollout_rmse_mm = row.fine_rmse_mm = error;
    return row;
}

std::vector<SolverRow> some_rows() {
    std::vector<SolverRow> rows = {
        row_named("bullet-2x1", 1, 5),     row_named("bullet-5x8", 4, 4),
        row_named("xpbd-10", 1, 3),        row_named("quasi-newton-3", 2, 1),
        row_named("newton-1", 10, 0.1),    row_named("fast+0", 5, 2),
        row_named("torch-fast+0", 20, 2.1)};
    rows[0].first_failed_frame = 7;
    rows[0].failure = "torn, \"all\"";
    return rows;
}

size_t count_of(const std::string& text, const std::string& part) {
    size_t count = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::stringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

}  // namespace

TEST(SolverRow, WhatDoesNotExistIsNullAndNeverNan) {
    const auto json = to_json(row_named("quasi-newton-3", 2, 1));
    for (const char* name : {"backend", "width", "refine", "ms_p95", "ms_ratio", "rmse_mm",
                             "penetration_max_mm", "first_failed_frame", "failure"})
        EXPECT_TRUE(json.at(name).is_null()) << name;
    SolverRow broken = row_named("fast+0", 1, std::numeric_limits<double>::infinity());
    broken.network = NetworkFacts{"engine", 32, 0};
    EXPECT_TRUE(to_json(broken).at("gap_median").is_null());
    EXPECT_EQ(to_json(broken).at("width"), 32);
    const std::string csv = to_csv({broken});
    EXPECT_EQ(csv.find("nan"), std::string::npos);
    EXPECT_EQ(csv.find("inf"), std::string::npos);
    EXPECT_EQ(csv.find("null"), std::string::npos);
}

TEST(SolverRow, TheTableHasEveryFieldOfTheJson) {
    const auto lines = lines_of(to_csv(some_rows()));
    ASSERT_EQ(lines.size(), 8u);
    std::string heading;
    const auto fields = to_json(SolverRow{});
    for (const auto& [name, value] : fields.items()) heading += (heading.empty() ? "" : ",") + name;
    EXPECT_EQ(lines[0], heading);
    EXPECT_EQ(
        lines[0].rfind("scene,fabric,solver,backend,width,refine,threads,frames,ms_median", 0), 0u);
    for (size_t k = 2; k < lines.size(); ++k)
        EXPECT_EQ(count_of(lines[k], ","), count_of(heading, ",")) << lines[k];
    EXPECT_NE(lines[1].find("true,7,\"torn, \"\"all\"\"\""), std::string::npos) << lines[1];
}

TEST(SolverFamily, NamesSayFamilyAndSetting) {
    EXPECT_EQ(solver_family("bullet").name, solver_family("bullet-5").name);
    EXPECT_EQ(solver_family("bullet-fine").name, "Bullet, 1/240 s");
    EXPECT_EQ(solver_family("bullet-5x8").name, "Bullet, 8 sub-steps");
    EXPECT_EQ(solver_family("quasi-newton-bdf2@8").name, "quasi-Newton, BDF2, limit of time");
    EXPECT_EQ(solver_family("quasi-newton@8").setting, "shipped@8");
    EXPECT_EQ(solver_family("default").name, solver_family("quasi-newton-3s120").name);
    EXPECT_EQ(solver_family("default@8").setting, "shipped@8");
    EXPECT_FALSE(network_facts("default@8", {}));
    EXPECT_EQ(solver_family("quasi-newton-5-bdf2~1000").name, "quasi-Newton, BDF2, proxy 1000");
    EXPECT_EQ(solver_family("small+3~tshirt_1000@20").setting, "+3@20");
    EXPECT_EQ(solver_family("bullet-5x1").setting, "5");
    EXPECT_EQ(solver_family("reference").name, solver_family("newton-3").name);
    EXPECT_EQ(solver_family("quasi-newton-3s120").setting, "3s120");
    EXPECT_EQ(solver_family("quasi-newton-3s120-bdf2").name, "quasi-Newton, small steps, BDF2");
    EXPECT_EQ(solver_family("quasi-newton-30").setting, "30");
    EXPECT_EQ(solver_family("quasi-newton").setting, "shipped");
    EXPECT_EQ(solver_family("quasi-newton").name, solver_family("quasi-newton-30").name);
    EXPECT_EQ(solver_family("quasi-newton-30-bdf2").name, "quasi-Newton, BDF2");
    EXPECT_EQ(solver_family("quasi-newton-30-bdf2").setting, "30");
    EXPECT_EQ(solver_family("fast-bdf2").name, "fast, BDF2");
    EXPECT_EQ(solver_family("fast").setting, "shipped");
    EXPECT_EQ(solver_family("torch-fast_16+3").name, "fast_16, LibTorch");
    EXPECT_EQ(solver_family("torch-fast_16+3").setting, "+3");
    EXPECT_EQ(solver_family("bf16-fast").name, "fast, bfloat16");
    EXPECT_EQ(solver_family("bf16-fast+3-bdf2").name, "fast, bfloat16, BDF2");
    EXPECT_EQ(solver_family("bf16-fast+3").setting, "+3");
}

TEST(SpeedErrorPlots, HaveEveryFamilyEverySettingAndEveryFailure) {
    const std::vector<SolverRow> rows = some_rows();
    const std::vector<NamedPlot> plots = speed_error_plots(rows);
    ASSERT_EQ(plots.size(), 4u);
    for (const NamedPlot& plot : plots) {
        for (const char* family :
             {"Bullet, 1 sub-steps", "Bullet, 8 sub-steps", "XPBD", "quasi-Newton", "Newton",
              "fast:", "fast, LibTorch", "rollout failed"})
            EXPECT_NE(plot.svg.find(family), std::string::npos) << plot.name << ": " << family;
        EXPECT_EQ(count_of(plot.svg, "<circle"), rows.size() - 1) << plot.name;
        EXPECT_EQ(count_of(plot.svg, "class=\"cross\""), 2u) << "the failure and the legend";
        EXPECT_NE(plot.svg.find("(ms, median)"), std::string::npos);
    }
    EXPECT_TRUE(speed_error_plots({}).empty());
}

}  // namespace cloth::rows_test
