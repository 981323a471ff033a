#include "demos/bake/options.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"
#include "demos/compare/arguments.h"

namespace cloth::bake_options_test {

namespace {

std::string refusal(const std::vector<std::string>& arguments) {
    try {
        parse_bake_options(arguments);
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(BakeOptions, DefaultsBakeTheWholeMotionOfTheProjectsBody) {
    const BakeOptions options = parse_bake_options({"--out", "shirt.pc2"});
    EXPECT_EQ(options.garment, "tshirt");
    EXPECT_EQ(options.motion, "01_01");
    EXPECT_EQ(options.frames, 0);
    EXPECT_EQ(options.body, "");
    EXPECT_FALSE(options.resume);
}

TEST(BakeOptions, ACharacterGetsTheGarmentAndTheMotion) {
    const BakeOptions options = parse_bake_options(
        {"--character", "dancer.glb", "--garment", "skirt.obj", "--motion", "turn", "--pin", "0.9",
         "1.1", "--rate", "24", "--frames", "48", "--out", "skirt.mdd"});
    EXPECT_EQ(options.character.garment, "skirt.obj");
    EXPECT_EQ(options.character.skin.animation, "turn");
    EXPECT_EQ(options.character.pin, (std::vector<double>{0.9, 1.1}));
    EXPECT_EQ(options.character.rate, 24);
    EXPECT_EQ(options.character.steps, 47) << "the first frame needs no step";
}

TEST(BakeOptions, WhatCannotBeRightIsRefusedByName) {
    const auto with_out = [](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), {"--out", "shirt.pc2"});
        return refusal(arguments);
    };
    EXPECT_NE(refusal({}).find("--out"), std::string::npos);
    EXPECT_NE(refusal({"--out", "shirt.abc"}).find("shirt.abc"), std::string::npos);
    EXPECT_NE(with_out({"--body", "body.fbx"}).find("body.fbx"), std::string::npos);
    EXPECT_NE(with_out({"--body", "shirt.pc2"}).find("--body"), std::string::npos);
    EXPECT_NE(with_out({"--garment", "toga"}).find("toga"), std::string::npos);
    EXPECT_NE(with_out({"--frames", "1"}).find("--frames"), std::string::npos);
    EXPECT_NE(with_out({"--rate", "9"}).find("--rate"), std::string::npos);
    EXPECT_NE(with_out({"--fabric", "silk"}).find("silk"), std::string::npos);
    EXPECT_NE(with_out({"--unit", "cm"}).find("--garment-scale"), std::string::npos);
    EXPECT_NE(with_out({"--frame", "3"}).find("--frame"), std::string::npos);
    EXPECT_NE(with_out({"--character", "a.glb", "--garment", "b.obj", "--pin", "1"}).find("--pin"),
              std::string::npos);
    EXPECT_EQ(with_out({"--frames", "2", "--rate", "24"}), "");
}

}  // namespace cloth::bake_options_test
