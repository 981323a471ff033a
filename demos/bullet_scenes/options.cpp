#include "demos/bullet_scenes/options.h"

#include <algorithm>

#include "demos/bullet_scenes/worlds/scenes.h"
#include "demos/compare/arguments.h"

namespace cloth {

std::string bullet_scenes_usage() {
    return "bullet_scenes: the cloth scenes of Bullet's demos, with Bullet's solver and with ours\n"
           "  --list            name the scenes\n"
           "  --scene A,B,...   only these\n"
           "  --solvers A,B     bullet, quasi-newton-K, or a network NAME[+K]; default "
           "bullet,small\n"
           "  --rates A,B,...   steps per second, default 60\n"
           "  --seconds N       of each run, default 10\n"
           "  --reference NAME  solver whose last shape is right, default quasi-newton-30; none\n"
           "  --weights DIR     folder with NAME.safetensors (default: the committed weights)\n"
           "  --out DIR         where bullet_scenes.json, the videos and pictures go\n"
           "  --no-videos\n";
}

namespace {

std::vector<int> rates_of(const std::string& value) {
    std::vector<int> rates;
    for (const std::string& rate : split_list(value))
        rates.push_back(whole_number("--rates", rate, 10, 1000));
    if (rates.empty()) throw UsageError("--rates: give at least one; see --help");
    return rates;
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
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        if (option == "--help" || option == "-h") throw UsageError(bullet_scenes_usage());
        if (option == "--list") {
            options.list = true;
            continue;
        }
        if (option == "--no-videos") {
            options.videos = false;
            continue;
        }
        if (i + 1 == arguments.size())
            throw UsageError(option + " is unknown or needs a value; see --help");
        const std::string& value = arguments[++i];
        if (option == "--scene")
            options.scenes = split_list(value);
        else if (option == "--solvers")
            options.solvers = split_list(value);
        else if (option == "--rates")
            options.rates = rates_of(value);
        else if (option == "--seconds")
            options.seconds = whole_number(option, value, 1, 600);
        else if (option == "--reference")
            options.reference = value;
        else if (option == "--weights")
            options.weights = value;
        else if (option == "--out")
            options.out = value;
        else
            throw UsageError("unknown option " + option + "; see --help");
    }
    check_scenes(options.scenes);
    if (options.solvers.empty()) throw UsageError("--solvers: name at least one; see --help");
    return options;
}

}  // namespace cloth
