#include "demos/bullet_scenes/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "demos/bullet_scenes/worlds/scenes.h"
#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"

namespace cloth {

namespace {

std::vector<int> numbers(const std::vector<std::string>& texts) {
    std::vector<int> rates;
    for (const std::string& text : texts) rates.push_back(whole_number("--rates", text, 10, 1000));
    return rates;
}

/// The groups "small" and "demos" become the names of their scenes.
std::vector<std::string> without_groups(const std::vector<std::string>& names) {
    std::vector<std::string> scenes;
    for (const std::string& name : names)
        if (name == "small" || name == "demos")
            for (const SceneRecipe& recipe : name == "small" ? smallScenes() : bulletsDemos())
                scenes.push_back(recipe.name);
        else
            scenes.push_back(name);
    return scenes;
}

void check_steps(const std::vector<std::string>& kinds) {
    for (const std::string& kind : kinds)
        if (kind != "even" && kind != "random")
            throw UsageError("--steps " + kind + " is unknown; choose of even, random");
}

void check_scenes(const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const SceneRecipe& recipe : sceneRecipes()) known.push_back(recipe.name);
    for (const std::string& name : names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw UsageError("--scene " + name + " is unknown; choose of " +
                             join_list(known, ", "));
}

}  // namespace

BulletScenesOptions parse_bullet_scenes_options(const std::vector<std::string>& arguments) {
    BulletScenesOptions options;
    std::vector<std::string> rates;
    bool no_videos = false;
    CLI::App app(
        "bullet_scenes: the cloth scenes of Bullet's demos, with Bullet's solver and with ours",
        "bullet_scenes");
    set_up(app);
    app.add_flag("--list", options.list, "name the scenes");
    add_list(app, "--scene", options.scenes,
             "only these; small: those of our own, demos: those of\nBullet's SoftDemo and "
             "SimpleCloth");
    add_list(app, "--solvers", options.solvers,
             "bullet, default (make_cloth() as it comes), quasi-newton-K,\n"
             "quasi-newton-KsR[-cgN] (R a second), xpbd-N, or a network NAME[+K];\n"
             "default bullet,default,small");
    add_list(app, "--rates", rates, "even steps per second, 10 to 1000, default 60");
    add_list(app, "--steps", options.steps,
             "even, random (of 1/240 to 1/30 s, the same in all runs);\ndefault even");
    add_whole_number(app, "--seconds", options.seconds, 1, 600, "of each run, default 10");
    app.add_option("--reference", options.reference,
                   "solver whose last shape is right, default quasi-newton-30;\nor none")
        ->type_name("NAME");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors (default: the committed weights)")
        ->type_name("DIR");
    app.add_option("--out", options.out, "where bullet_scenes.json, the videos and pictures go")
        ->type_name("DIR");
    app.add_flag("--no-videos", no_videos, "pictures and figures only");
    parse(app, arguments);
    options.videos = !no_videos;
    if (!rates.empty()) options.rates = numbers(rates);
    check_steps(options.steps);
    options.scenes = without_groups(options.scenes);
    check_scenes(options.scenes);
    return options;
}

}  // namespace cloth
