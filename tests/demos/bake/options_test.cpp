#include "demos/bake/options.h"

#include <gtest/gtest.h>

#include <tuple>

#include "data/core/errors.h"
#include "demos/compare/arguments.h"
#include "tests/data/files/file_fixture.h"

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
    EXPECT_EQ(with_out({"--frames", "2.5"}).find("--frames 2.5: give a whole number"), 0u);
    EXPECT_EQ(with_out({"--rate", "29.97"}).find("--rate 29.97: give a whole number"), 0u);
    EXPECT_EQ(with_out({"--frames", "2", "--rate", "24"}), "");
}

TEST(BakeOptions, WhatIsForACharacterIsRefusedWithoutOne) {
    for (const std::vector<std::string>& option :
         std::vector<std::vector<std::string>>{{"--skin", "body"},
                                               {"--character-scale", "0.01"},
                                               {"--garment-scale", "1"},
                                               {"--weld", "0.0001"},
                                               {"--clearance", "0.01"},
                                               {"--pin", "0.9", "1.1"},
                                               {"--goal-colours", "0.1"},
                                               {"--settle", "1"}}) {
        std::vector<std::string> arguments = {"--out", "shirt.pc2"};
        arguments.insert(arguments.end(), option.begin(), option.end());
        EXPECT_EQ(refusal(arguments).find(option[0] + ": it is for a --character"), 0u)
            << refusal(arguments);
        arguments.insert(arguments.end(), {"--character", "a.glb", "--garment", "b.obj"});
        EXPECT_EQ(refusal(arguments), "");
    }
    EXPECT_NE(refusal({"--out", "a.pc2", "--character", "a.glb", "--goal-colours", "0"})
                  .find("GoalColours.max_distance"),
              std::string::npos)
        << "0 is no way to say no";
}

TEST(BakeOptions, CachesAreNotWrittenOverEachOther) {
    for (const auto& [out, body, problem] :
         std::vector<std::tuple<std::string, std::string, std::string>>{
             {"o/s.pc2", "./o/s.pc2", "give another file"},
             {"o/s", "o/../o/s/", "give another file"},
             {"o/t.pc2", "o/t.mdd", "t_rest.obj would be written"},
             {"t.usda", "./t.pc2", "t_rest.obj would be written"},
             {"o/p.pc2", "o/p", "o/p_rest.obj would be written"},
             {"o/p/", "o/p.pc2", "o/p_rest.obj would be written"}}) {
        const std::string message = refusal({"--out", out, "--body", body});
        EXPECT_EQ(message.find("--body " + body + ": "), 0u) << message;
        EXPECT_NE(message.find(problem), std::string::npos) << message;
    }
    EXPECT_EQ(refusal({"--out", "o/t.pc2", "--body", "p/t.pc2"}), "");
    EXPECT_EQ(refusal({"--out", "o/shirt.pc2", "--body", "o/body.pc2"}), "");
}

using BakedFile = test::FileTest;

TEST_F(BakedFile, WhatIsReadIsNotOverwritten) {
    write("skirt_rest.obj", "");
    write("shirt.obj", "");
    write("dancer.glb", "");
    std::filesystem::create_symlink(path(""), path("link"));
    const auto refusal_of = [&](const std::string& out, const std::string& body) {
        return refusal({"--character", path("dancer.glb"), "--garment",
                        path("shirt.obj") + "+" + path("skirt_rest.obj"), "--out", path(out),
                        "--body", path(body)});
    };
    EXPECT_EQ(refusal_of("skirt.pc2", "body.pc2")
                  .find("--out " + path("skirt.pc2") + ": " + path("skirt_rest.obj") +
                        " would be overwritten"),
              0u);
    EXPECT_NE(refusal_of("link/skirt.pc2", "body.pc2").find("would be overwritten"),
              std::string::npos);
    EXPECT_NE(refusal_of("out.pc2", "skirt.mdd").find("would be overwritten"), std::string::npos);
    EXPECT_NE(refusal_of("dancer.glb", "body.pc2").find("dancer.glb would be overwritten"),
              std::string::npos);
    EXPECT_EQ(refusal_of("out.pc2", "body.pc2"), "");
}

}  // namespace cloth::bake_options_test
