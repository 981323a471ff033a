#include "demos/bullet_scenes/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "demos/bullet_scenes/report.h"
#include "demos/bullet_scenes/worlds/scenes.h"
#include "demos/compare/arguments.h"

namespace cloth::options_test {

namespace {

std::string error_of(const std::vector<std::string>& arguments) {
    try {
        parse_bullet_scenes_options(arguments);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(BulletScenesOptions, AreRead) {
    const BulletScenesOptions options =
        parse_bullet_scenes_options({"--scene", "sphere,stack", "--rates", "30,240", "--solvers",
                                     "bullet", "--seconds", "3", "--out", "there", "--no-videos"});
    EXPECT_EQ(options.scenes, (std::vector<std::string>{"sphere", "stack"}));
    EXPECT_EQ(options.rates, (std::vector<int>{30, 240}));
    EXPECT_EQ(options.solvers, std::vector<std::string>{"bullet"});
    EXPECT_EQ(options.seconds, 3);
    EXPECT_EQ(options.out, "there");
    EXPECT_FALSE(options.videos);
    EXPECT_TRUE(parse_bullet_scenes_options({"--list"}).list);
}

TEST(BulletScenesOptions, StepsAndGroupsAreRead) {
    EXPECT_EQ(parse_bullet_scenes_options({}).steps, std::vector<std::string>{"even"});
    EXPECT_EQ(parse_bullet_scenes_options({"--steps", "even,random"}).steps,
              (std::vector<std::string>{"even", "random"}));
    const std::vector<std::string> scenes =
        parse_bullet_scenes_options({"--scene", "demos,ball"}).scenes;
    ASSERT_EQ(scenes.size(), bulletsDemos().size() + 1);
    EXPECT_EQ(scenes.front(), bulletsDemos().front().name);
    EXPECT_EQ(scenes.back(), "ball");
}

TEST(BulletScenesOptions, MistakesAreNamed) {
    EXPECT_NE(error_of({"--scene", "moon"}).find("hanging"), std::string::npos);
    EXPECT_NE(error_of({"--rates", "fast"}).find("--rates"), std::string::npos);
    EXPECT_NE(error_of({"--rates", "5"}).find("10"), std::string::npos);
    EXPECT_NE(error_of({"--out"}).find("--out"), std::string::npos);
    EXPECT_NE(error_of({"--steps", "uneven"}).find("random"), std::string::npos);
    EXPECT_NE(error_of({"--nonsense", "1"}).find("--nonsense"), std::string::npos);
    EXPECT_NE(error_of({"--solvers", ","}).find("--solvers"), std::string::npos);
}

TEST(BulletScenes, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const SceneRecipe& recipe : smallScenes()) names.insert(recipe.name);
    EXPECT_EQ(names, (std::set<std::string>{"hanging", "attached", "flag", "sphere", "box_edge",
                                            "capsule", "mesh", "stack", "ball", "mixed"}));
    for (const SceneRecipe& recipe : bulletsDemos()) names.insert(recipe.name);
    for (const SceneRecipe& recipe : manySheets()) names.insert(recipe.name);
    EXPECT_EQ(names.size(), smallScenes().size() + bulletsDemos().size() + manySheets().size());
    EXPECT_EQ(names.size(), sceneRecipes().size());
}

TEST(BulletScenes, RowsAreJsonWithNullsForWhatHasNoMeaning) {
    SceneRow row;
    row.scene = "flag";
    row.solver = "fast";
    row.rate_hz = 60;
    row.rest_error_mm = row.momentum_error = std::numeric_limits<double>::quiet_NaN();
    row.rest_energy_mm = row.rest_error_mm;
    row.ms_median = 1.5;
    const nlohmann::ordered_json json = scene_row_json(row);
    EXPECT_TRUE(json.at("rest_error_mm").is_null());
    EXPECT_TRUE(json.at("rest_energy_mm").is_null());
    EXPECT_TRUE(json.at("momentum_error").is_null());
    EXPECT_EQ(json.at("ms_median"), 1.5);
    EXPECT_EQ(json.at("rate_hz"), 60);
}

}  // namespace cloth::options_test
