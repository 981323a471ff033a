#include "demos/viewer/options.h"

#include <gtest/gtest.h>

#include "demos/compare/arguments.h"

namespace cloth::viewer_options_test {

namespace {

std::string refusal(const std::vector<std::string>& arguments) {
    try {
        parse_viewer_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(ViewerOptions, DefaultsShowATShirtUntilTheWindowIsClosed) {
    const ViewerOptions options = parse_viewer_options({});
    EXPECT_EQ(options.scene.garment, "tshirt");
    EXPECT_EQ(options.scene.motion, "01_01");
    EXPECT_EQ(options.scene.shape, "default");
    EXPECT_EQ(options.frames, 0);
    EXPECT_EQ(options.screenshot, "");
    EXPECT_FALSE(options.paused);
}

TEST(ViewerOptions, ScenesAreThoseOfBake) {
    const ViewerOptions options = parse_viewer_options(
        {"--character", "dancer.glb", "--garment", "skirt.obj", "--motion", "turn", "--rate", "60",
         "--solver", "xpbd-20", "--pin", "0.9", "1.1"});
    EXPECT_EQ(options.scene.character.garment, "skirt.obj");
    EXPECT_EQ(options.scene.character.skin.animation, "turn");
    EXPECT_EQ(options.scene.character.rate, 60);
    EXPECT_EQ(options.scene.character.steps, 0) << "the whole animation";
    EXPECT_EQ(parse_viewer_options({"--body", "heavy"}).scene.shape, "heavy");
}

TEST(ViewerOptions, WhatCannotBeRightIsRefusedByName) {
    EXPECT_NE(refusal({"--garment", "toga"}).find("toga"), std::string::npos);
    EXPECT_NE(refusal({"--body", "giant"}).find("giant"), std::string::npos);
    for (const std::string speed : {"50", "-1", "nan", "2x", ""})
        EXPECT_EQ(
            refusal({"--wind", speed}).find("--wind " + speed + ": give a number from 0 to 20"),
            0u);
    EXPECT_NE(refusal({"--colours", "heat"}).find("--colours"), std::string::npos);
    EXPECT_NE(refusal({"--width", "10"}).find("--width"), std::string::npos);
    EXPECT_NE(refusal({"--body", "heavy", "--character", "a.glb"}).find("--character"),
              std::string::npos);
    EXPECT_EQ(refusal({"--body", "heavy"}), "");
    EXPECT_EQ(refusal({"--pin", "0.9", "1.1"}).find("--pin: it is for a --character"), 0u);
    EXPECT_NE(refusal({"--screenshot", "x.jpg"}).find(".png"), std::string::npos);
    EXPECT_EQ(refusal({"--screenshot", "x.PNG"}), "");
    EXPECT_NE(refusal({"--frames", "5", "--paused"}).find("--frames"), std::string::npos);
}

}  // namespace cloth::viewer_options_test
