#include "demos/many_characters/crowd.h"

#include <gtest/gtest.h>

#include "demos/compare/arguments.h"
#include "demos/many_characters/crowd_run.h"

namespace cloth::crowd_test {

namespace {

const auto quiet = [](int, int, const std::string&) {};

std::string message(const std::vector<std::string>& arguments) {
    try {
        parse_many_characters_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(ManyCharacters, BothWaysOfSteppingGiveTheSameBits) {
    ManyCharactersOptions options;
    options.characters = 3;
    options.motions = {"01_01", "01_03"};
    options.warm_up = 3;
    options.frames = 3;
    const std::vector<CrowdRow> rows = measure_crowd(options, "quasi-newton-3", quiet);
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_FALSE(rows[0].parallel);
    EXPECT_TRUE(rows[1].parallel);
    for (const CrowdRow& row : rows) {
        EXPECT_TRUE(row.same_bits);
        EXPECT_EQ(row.characters, 3);
        EXPECT_EQ(row.frames, 3);
        EXPECT_NEAR(row.vertices, 1000, 30);
        EXPECT_EQ(row.failed_steps, 0);
        EXPECT_GT(row.ms_median, 0.0);
        EXPECT_NEAR(row.characters_per_frame() * row.ms_median, 3 * 1e3 / 30, 1e-6);
    }
}

TEST(ManyCharacters, TheyMoveApartAndEachInItsTime) {
    const auto body = std::make_shared<const Body>(Body::load_default());
    Crowd crowd(body, {load_motion_by_name("01_01")}, {2, "tshirt_1000", "quasi-newton-3", true});
    for (int frame = 0; frame < 10; ++frame) EXPECT_GT(crowd.step(), 0.0);
    const Points first = crowd.nodes(0), second = crowd.nodes(1);
    const Eigen::RowVector3d offset = second.colwise().mean() - first.colwise().mean();
    EXPECT_NEAR(offset.x(), 2.0, 0.1);
    EXPECT_GT((second - first).rowwise().norm().maxCoeff(), 2.0 + 1e-4) << "not the same pose";
    EXPECT_EQ(crowd.solver().status().clothBodies, 2);
}

TEST(ManyCharacters, WhatCannotBeIsNamed) {
    EXPECT_NE(message({"--garment", "toga"}).find("toga"), std::string::npos);
    EXPECT_NE(message({"--characters", "0"}).find("--characters"), std::string::npos);
    EXPECT_EQ(parse_many_characters_options({}).characters, 10);
    EXPECT_EQ(parse_many_characters_options({"--solvers", "small"}).solvers,
              std::vector<std::string>{"small"});
    EXPECT_EQ(crowd_motions().front(), "01_01");
    ManyCharactersOptions options;
    EXPECT_THROW(measure_crowd(options, "bulet", quiet), UsageError);
}

}  // namespace cloth::crowd_test
