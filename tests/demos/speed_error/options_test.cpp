#include "demos/speed_error/options.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "demos/compare/arguments.h"
#include "demos/speed_error/pinning.h"
#include "demos/speed_error/scenes.h"

namespace cloth::options_test {

namespace {

std::string message(const std::vector<std::string>& arguments) {
    try {
        parse_speed_error_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << text;
}

}  // namespace

TEST(SpeedErrorOptions, DefaultsAreOneSceneAndFabric) {
    const SpeedErrorOptions options = parse_speed_error_options({});
    EXPECT_EQ(options.scenes, std::vector<std::string>{"tshirt"});
    EXPECT_EQ(options.fabrics, std::vector<std::string>{"soft"});
    EXPECT_TRUE(options.solvers.empty());
    EXPECT_FALSE(options.limbs);
    EXPECT_TRUE(parse_speed_error_options({"--limbs"}).limbs);
}

TEST(SpeedErrorOptions, AllAndBothAreEveryChoice) {
    const SpeedErrorOptions options =
        parse_speed_error_options({"--scene", "all", "--fabric", "both", "--solvers", "a,b"});
    EXPECT_EQ(options.scenes, scene_names());
    EXPECT_EQ(options.fabrics, (std::vector<std::string>{"soft", "real"}));
    EXPECT_EQ(options.solvers, (std::vector<std::string>{"a", "b"}));
}

TEST(SpeedErrorOptions, WhatCannotBeIsNamedWithItsChoices) {
    expect_words(message({"--scene", "moon"}), {"--scene", "moon", "sheet", "tshirt", "sphere"});
    expect_words(message({"--fabric", "silk"}), {"--fabric", "silk", "soft", "real", "both"});
    expect_words(message({"--rate", "50"}), {"--rate", "50", "30", "60", "120"});
    expect_words(message({"--frames", "-1"}), {"--frames", "-1", "0"});
    expect_words(message({"--frames", "ten"}), {"--frames", "ten"});
    expect_words(message({"--vertices", "99"}), {"--vertices", "99", "100", "20000"});
    expect_words(message({"--threads", "257"}), {"--threads", "257", "256"});
    expect_words(message({"--solvers", ","}), {"--solvers"});
    expect_words(message({"--frame", "3"}), {"--frame"});
    expect_words(message({"--out"}), {"--out", "required"});
}

TEST(SpeedErrorOptions, AGarmentTakesTheTshirtsPlaceAndName) {
    const auto scenes = [](const std::vector<std::string>& arguments) {
        return parse_speed_error_options(arguments).scenes;
    };
    EXPECT_EQ(scenes({"--garment", "skirt"}), std::vector<std::string>{"skirt"});
    EXPECT_EQ(scenes({"--scene", "all", "--garment", "skirt"}),
              (std::vector<std::string>{"sheet", "skirt", "sphere"}));
    EXPECT_EQ(scenes({"--scene", "sheet", "--garment", "skirt"}),
              std::vector<std::string>{"sheet"});
    expect_words(message({"--garment", "toga"}), {"toga", "skirt", "tshirt_1000"});
}

TEST(SpeedErrorOptions, HelpNamesEveryOption) {
    expect_words(message({"--help"}), {"--scene", "--garment", "--fabric", "--frames", "--vertices",
                                       "--solvers", "--relative-to", "--weights", "--threads",
                                       "--out", "gap_median", "peak_memory_mb"});
}

TEST(SpeedErrorOptions, DefaultSolversHaveEachNetworkInEachBackend) {
    const auto count = [](const std::vector<std::string>& solvers, const std::string& part) {
        int found = 0;
        for (const std::string& solver : solvers) found += solver.find(part) != std::string::npos;
        return found;
    };
    const auto with = default_solvers({"baseline", "fast_16"}, true);
    const auto without = default_solvers({"baseline", "fast_16"}, false);
    EXPECT_EQ(count(with, "fast_16"), 7);
    EXPECT_EQ(count(with, "torch-"), 2);
    EXPECT_EQ(count(without, "torch-"), 0);
    EXPECT_EQ(count(without, "bullet-"), 12);
    EXPECT_EQ(count(without, "xpbd-"), 4);
    EXPECT_EQ(count(without, "quasi-newton"), 13);
    EXPECT_EQ(count(without, "-bdf2"), 6);
    EXPECT_EQ(std::count(without.begin(), without.end(), "fast_16"), 1) << "as shipped";
    EXPECT_EQ(count(without, "reference"), 1);
}

TEST(Pinning, MoreThreadsThanCoresAreRefused) {
    EXPECT_THROW(pin_threads(5000), UsageError);
}

}  // namespace cloth::options_test
