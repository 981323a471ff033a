#include <gtest/gtest.h>

#include "demos/compare/arguments.h"
#include "demos/scaling/options.h"

namespace cloth::scaling_options_test {

namespace {

std::string message(const std::vector<std::string>& arguments) {
    try {
        parse_scaling_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(ScalingOptions, DefaultsAreTwoScenesFromOneThousandToFiftyThousand) {
    const ScalingOptions options = parse_scaling_options({});
    EXPECT_EQ(options.scenes, (std::vector<std::string>{"sphere", "dress"}));
    EXPECT_EQ(options.vertices.front(), 1000);
    EXPECT_EQ(options.vertices.back(), 50000);
}

TEST(ScalingOptions, ListsAreTaken) {
    const ScalingOptions options = parse_scaling_options(
        {"--vertices", "600,700", "--scenes", "dress", "--solvers", "a,b", "--frames", "2"});
    EXPECT_EQ(options.vertices, (std::vector<int>{600, 700}));
    EXPECT_EQ(options.scenes, std::vector<std::string>{"dress"});
    EXPECT_EQ(options.solvers, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(options.frames, 2);
}

TEST(ScalingOptions, WhatCannotBeIsNamed) {
    EXPECT_NE(message({"--scenes", "moon"}).find("moon: choose of sphere, dress"),
              std::string::npos);
    EXPECT_NE(message({"--vertices", "600,60001"}).find("60001"), std::string::npos);
    EXPECT_NE(message({"--vertices", "many"}).find("many"), std::string::npos);
    EXPECT_NE(message({"--frames", "0"}).find("--frames"), std::string::npos);
}

}  // namespace cloth::scaling_options_test
