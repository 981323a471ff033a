#include "demos/import_garment/options.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"
#include "demos/compare/arguments.h"

namespace cloth::import_options_test {

namespace {

std::string refusal(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "skirt.obj");
    try {
        parse_import_options(arguments);
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(ImportOptions, DefaultsTakeAFileInMetresOnTheProjectsBody) {
    const ImportOptions options = parse_import_options({"some/skirt.obj"});
    EXPECT_EQ(options.file, "some/skirt.obj");
    EXPECT_EQ(options.name, "skirt");
    EXPECT_EQ(options.scale, 1.0);
    EXPECT_FALSE(options.z_up);
    EXPECT_EQ(options.body, "default");
    EXPECT_EQ(options.character, "");
    EXPECT_EQ(options.import.vertices, 0);
    EXPECT_TRUE(options.picture);
}

TEST(ImportOptions, UnitsAreNamedOrNumbers) {
    EXPECT_EQ(parse_import_options({"a.obj", "--unit", "cm"}).scale, 0.01);
    EXPECT_EQ(parse_import_options({"a.obj", "--scale", "0.3"}).scale, 0.3);
    const ImportOptions options =
        parse_import_options({"a.obj", "--character", "b.glb", "--character-unit", "in", "--up",
                              "z", "--move", "1", "-2", "3"});
    EXPECT_EQ(options.skin.scale, 0.0254);
    EXPECT_TRUE(options.z_up);
    EXPECT_EQ(options.move, Vec3(1, -2, 3));
}

TEST(ImportOptions, WhatCannotBeRightIsRefusedByName) {
    for (const auto& [arguments, part] :
         std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"--unit", "yard"}, "unit yard"},
             {{"--unit", "cm", "--scale", "0.01"}, "--scale"},
             {{"--scale", "0"}, "--scale"},
             {{"--scale", "nan"}, "--scale"},
             {{"--up", "x"}, "--up"},
             {{"--move", "1", "2"}, "--move"},
             {{"--move", "1", "2", "1e9"}, "--move"},
             {{"--vertices", "499"}, "vertices"},
             {{"--vertices", "60001"}, "--vertices"},
             {{"--weld", "0.02"}, "weld"},
             {{"--clearance", "0"}, "clearance"},
             {{"--most-inside", "2"}, "most_inside"},
             {{"--smallest-piece", "-1"}, "smallest_piece"},
             {{"--band-ratio", "0.4"}, "band_ratio"},
             {{"--body", "giant"}, "giant"},
             {{"--body", "heavy", "--character", "b.glb"}, "--character"},
             {{"--character-scale", "0.01"}, "--character-scale requires --character"},
             {{"--character-unit", "cm"}, "--character-unit requires --character"},
             {{"--skin", "body"}, "--skin requires --character"},
             {{"--name", "a/b"}, "--name"},
             {{"--what"}, "--what"}}) {
        const std::string message = refusal(arguments);
        EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    }
    EXPECT_THROW(parse_import_options({}), UsageError);
    EXPECT_THROW(parse_import_options({"--help"}), HelpText);
}

}  // namespace cloth::import_options_test
