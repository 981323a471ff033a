// What is measured, by default and as the options say.

#include "demos/paper_tables/options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "demos/compare/arguments.h"
#include "demos/paper_tables/plan.h"
#include "render/replaced_file.h"

namespace cloth::paper_options_test {

namespace {

std::string refusal(const std::vector<std::string>& arguments) {
    try {
        parse_paper_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::count(names.begin(), names.end(), name) == 1;
}

}  // namespace

TEST(PaperOptions, AreReadOrRefused) {
    const PaperOptions options = parse_paper_options(
        {"--garments", "dress,pants", "--frames", "7", "--no-training", "--out", "x"});
    EXPECT_EQ(options.garments, (std::vector<std::string>{"dress", "pants"}));
    EXPECT_EQ(options.frames, 7);
    EXPECT_EQ(options.train, "");
    EXPECT_EQ(options.references, "x/parts");
    EXPECT_NE(parse_paper_options({}).train, "");
    EXPECT_NE(refusal({"--frames", "-1"}).find("--frames"), std::string::npos);
    EXPECT_NE(refusal({"--garments", "toga"}).find("garment toga: choose one of"),
              std::string::npos);
    EXPECT_NE(refusal({"--training-iterations", "3"}).find("--training-iterations"),
              std::string::npos);
    EXPECT_NE(refusal({"--tables", "2"}).find("unknown option"), std::string::npos);
    EXPECT_THROW(parse_paper_options({"--help"}), HelpText);
}

TEST(PaperPlan, HasTheRowsOfThePaperOnItsGarments) {
    const std::vector<GarmentPlan> plan = paper_plan({});
    ASSERT_EQ(plan.size(), 4u);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(plan[k].garment, (std::vector<std::string>{"tshirt", "pants", "dress"})[k]);
        for (const char* solver : {"baseline+0", "sampling+0", "reduction+0", "fast+0", "hood+0",
                                   "hood_fast+3", "bistride+3", "reference", "bullet", "xpbd-40"})
            EXPECT_TRUE(has(plan[k].solvers, solver)) << solver;
    }
    EXPECT_EQ(plan[3].garment, "tshirt_1000");
    EXPECT_TRUE(has(plan[3].solvers, "skinning"));
    EXPECT_LT(plan[2].frames, plan[0].frames) << "the dress's references take longest";
}

TEST(PaperPlan, IsWhatTheOptionsSay) {
    PaperOptions options;
    options.garments = {"dress", "shorts"};
    options.solvers = {"xpbd-40"};
    const std::vector<GarmentPlan> plan = paper_plan(options);
    ASSERT_EQ(plan.size(), 2u);
    EXPECT_EQ(plan[0].frames, paper_plan({})[2].frames);
    EXPECT_EQ(plan[1].garment, "shorts");
    EXPECT_EQ(plan[1].solvers, options.solvers);
    options.frames = 5;
    EXPECT_EQ(paper_plan(options)[0].frames, 5);
}

TEST(PaperPlan, ANetworkOfThePaperMayLackItsWeightsAndNoOther) {
    const std::string folder = ::testing::TempDir() + "paper_weights";
    std::filesystem::create_directories(folder);
    write_text_file(folder + "/fast.safetensors", "x");
    EXPECT_EQ(what_is_missing("fast+0", "tshirt", folder), "");
    EXPECT_EQ(what_is_missing("quasi-newton-3", "tshirt", folder), "");
    EXPECT_EQ(what_is_missing("hood+3", "tshirt", folder), "not trained yet: no hood.safetensors");
    EXPECT_EQ(what_is_missing("skinning", "dress", folder),
              "not trained yet: no dress.safetensors");
    EXPECT_THROW(what_is_missing("hoood+3", "tshirt", folder), UsageError);
    EXPECT_EQ(weights_of("bullet", "tshirt", folder), "");
    std::filesystem::remove_all(folder);
}

}  // namespace cloth::paper_options_test
