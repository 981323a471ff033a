// bullet_scenes: the cloth scenes of Bullet's demos, with Bullet's solver and with ours. See
// --help.

#include <cstdio>
#include <filesystem>

#include "demos/bullet_scenes/options.h"
#include "demos/bullet_scenes/report.h"
#include "demos/bullet_scenes/scene_film.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"

using namespace cloth;

namespace {

constexpr int kPicturesPerSecond = 30;

bool wanted(const BulletScenesOptions& options, const std::string& name) {
    if (options.scenes.empty()) return true;
    for (const std::string& scene : options.scenes)
        if (scene == name) return true;
    return false;
}

/// All solvers on one scene at one rate.
std::vector<SceneResult> run_rate(const BulletScenesOptions& options, const SceneRecipe& recipe,
                                  int rate, const SceneSolvers& solvers, Progress& line) {
    SceneRunSettings settings;
    settings.rate = rate;
    settings.seconds = options.seconds;
    const auto run = [&](const std::string& solver) {
        settings.solver = solver;
        return run_scene(recipe, settings, solvers, [&](int done, int all) {
            line.update(done, all, std::string(recipe.name) + ", " + solver);
        });
    };
    SceneResult reference;
    const bool compare = recipe.comes_to_rest && options.reference != "none";
    if (compare) reference = run(options.reference);
    if (options.videos) settings.pictures_per_second = kPicturesPerSecond;
    std::vector<SceneResult> results;
    for (const std::string& solver : options.solvers) {
        SceneResult result = run(solver);
        if (compare && result.row.finite) {
            result.row.rest_error_mm = shape_distance_mm(result.last, reference.last);
            result.row.rest_energy_mm = energy_distance_mm(result.energy, reference.energy);
        }
        result.row.momentum_error = momentum_error(recipe, settings, solvers);
        std::printf("%s\n", scene_row_text(result.row).c_str());
        for (const std::string& message : result.messages) std::printf("  %s\n", message.c_str());
        std::fflush(stdout);
        results.push_back(std::move(result));
    }
    return results;
}

void run(const BulletScenesOptions& options) {
    if (options.list) {
        for (const SceneRecipe& recipe : sceneRecipes())
            std::printf("%-10s %s\n", recipe.name, recipe.sentence);
        return;
    }
    const SceneSolvers solvers(options.weights);
    for (const std::string& solver : options.solvers) solvers.make(solver);  // errors come first
    std::filesystem::create_directories(options.out);
    std::vector<SceneRow> rows;
    Progress line;
    std::printf("%s\n", scene_row_heading().c_str());
    for (const SceneRecipe& recipe : sceneRecipes()) {
        if (!wanted(options, recipe.name)) continue;
        for (int rate : options.rates) {
            const auto results = run_rate(options, recipe, rate, solvers, line);
            for (const SceneResult& result : results) rows.push_back(result.row);
            write_scene_report(options.out + "/bullet_scenes.json", rows);
            const std::string film = options.out + "/" + recipe.name +
                                     (options.rates.size() > 1 ? "_" + std::to_string(rate) : "") +
                                     ".mp4";
            make_scene_film(recipe, results, kPicturesPerSecond, film, [&](int done, int all) {
                line.update(done, all, std::string(recipe.name) + ", video");
            });
        }
    }
    std::printf("%s/bullet_scenes.json\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        run(parse_bullet_scenes_options(arguments));
    });
}
