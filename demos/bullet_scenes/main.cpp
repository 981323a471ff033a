// bullet_scenes: the cloth scenes of Bullet's demos, with Bullet's solver and with ours. See
// --help.

#include <cstdio>

#include "data/files/make_folder.h"
#include "demos/bullet_scenes/options.h"
#include "demos/bullet_scenes/report.h"
#include "demos/bullet_scenes/scene_film.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

constexpr int kPicturesPerSecond = 30;

bool wanted(const BulletScenesOptions& options, const std::string& name) {
    if (options.scenes.empty()) return true;
    for (const std::string& scene : options.scenes)
        if (scene == name) return true;
    return false;
}

std::vector<StepPlan> plans(const BulletScenesOptions& options) {
    std::vector<StepPlan> all;
    for (const std::string& kind : options.steps) {
        StepPlan plan;
        plan.random = kind == "random";
        if (plan.random) all.push_back(plan);
        for (int rate : options.rates) {
            plan.rate = rate;
            if (!plan.random) all.push_back(plan);
        }
    }
    return all;
}

std::string plan_name(const StepPlan& plan) {
    return plan.random ? "random" : std::to_string(plan.rate);
}

/// How many times as long as Bullet's solver each one took, if that is among them.
void compare_times(std::vector<SceneResult>& results) {
    for (const SceneResult& bullet : results)
        if (bullet.row.solver == "bullet")
            for (SceneResult& result : results)
                result.row.times_bullet = result.row.ms_mean / bullet.row.ms_mean;
}

/// All solvers on one scene with the same steps.
std::vector<SceneResult> run_plan(const BulletScenesOptions& options, const SceneRecipe& recipe,
                                  const StepPlan& plan, const SceneSolvers& solvers,
                                  Progress& line) {
    SceneRunSettings settings;
    settings.steps = plan;
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
        results.push_back(std::move(result));
    }
    compare_times(results);
    for (const SceneResult& result : results) {
        std::printf("%s\n", scene_row_text(result.row).c_str());
        for (const std::string& message : result.messages) std::printf("  %s\n", message.c_str());
    }
    std::fflush(stdout);
    return results;
}

void run(const BulletScenesOptions& options) {
    if (options.list) {
        for (const SceneRecipe& recipe : sceneRecipes())
            std::printf("%-16s %s\n", recipe.name, recipe.sentence);
        return;
    }
    const SceneSolvers solvers(options.weights);
    for (const std::string& solver : options.solvers) solvers.make(solver);  // errors come first
    make_folder(options.out);
    std::vector<SceneRow> rows;
    Progress line;
    std::printf("%s\n", scene_row_heading().c_str());
    for (const SceneRecipe& recipe : sceneRecipes()) {
        if (!wanted(options, recipe.name)) continue;
        const std::vector<StepPlan> wanted_plans = plans(options);
        for (const StepPlan& plan : wanted_plans) {
            const auto results = run_plan(options, recipe, plan, solvers, line);
            for (const SceneResult& result : results) rows.push_back(result.row);
            write_scene_report(options.out + "/bullet_scenes.json", rows);
            const std::string film = options.out + "/" + recipe.name +
                                     (wanted_plans.size() > 1 ? "_" + plan_name(plan) : "") +
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
        remove_temporary_files_at_signals();
        run(parse_bullet_scenes_options(arguments));
    });
}
