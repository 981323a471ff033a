// Trains a cloth network on the incremental potential.
//
//     train --iterations 250000 --out out/kicks
//     train --variant baseline --recipe paper --width 128 --steps 21 --device cuda
//           --iterations 110000 --out out/baseline

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/files/garment_assets.h"
#include "demos/local_processes.h"
#include "demos/train_recipe.h"
#include "demos/training_program.h"
#include "gnn/train/process_group.h"
#include "gnn/train/trainer.h"

namespace {

struct Options {
    cloth::TrainerSettings settings;
    std::string variant = "fast", recipe = "kicks", loss;
    int width = 32, nice = 0;
    double rate = 30.0;  ///< 1/s
    std::optional<int> steps, levels, sampled_edges, batch;
    int processes = 1;
    bool force_features = true, resume = false;
    std::map<std::string, double> recipe_values;  ///< of recipe_options()
};

/// @throws ArgumentError if one is not found or, with proxies, has none: before hours are spent on
///         the others alone
void choose_garments(const std::vector<std::string>& names, cloth::SceneSettings& scenes) {
    const std::vector<std::string> proxied = cloth::proxied_garments();
    if (scenes.proxies) {
        scenes.garment_share = 1.0;
        scenes.garments = proxied;
    }
    for (const std::string& name : names) {
        if (scenes.proxies && std::find(proxied.begin(), proxied.end(), name) == proxied.end())
            throw cloth::ArgumentError(
                "--garment " + name,
                "has no coarse garment of 1,000 vertices that could be its proxy",
                "take another of the wardrobe, or leave --proxies out");
        cloth::load_garment_start(name);
    }
    if (!names.empty() && scenes.garment_share == 0.0)
        throw cloth::ArgumentError("--garment", "has no effect with --garment-share 0",
                                   "leave one of them out");
    if (!names.empty()) scenes.garments = names;
}

Options parse(int count, char** arguments) {
    Options options;
    cloth::TrainerSettings& settings = options.settings;
    std::vector<std::string> garments;
    CLI::App app("train: trains a cloth network on the incremental potential, without ground truth",
                 "train");
    app.option_defaults()->take_last();
    const auto add = [&app](const char* name, auto& value, const char* type,
                            const char* description, const char* group = "Options") {
        return app.add_option(name, value, description)->type_name(type)->group(group);
    };
    add("--variant", options.variant, "NAME",
        "baseline, sampling, reduction or fast; with coarse levels hood, hood_fast or bistride "
        "(fast)");
    add("--width", options.width, "D",
        "latent size, 4 to 512; other than multiples of 16 train slowly, without validation "
        "(--validation-share 0), and for LibTorch alone (32)");
    add("--steps", options.steps, "L", "message passing steps (8, with coarse levels 15)");
    add("--levels", options.levels, "K",
        "coarse levels of hood, hood_fast and bistride, 1 to 6; takes 2 K + 1 steps or more (2)");
    add("--sampled-edges", options.sampled_edges, "K",
        "neighbours that a vertex hears in a message passing step, 1 to 32, of variants that "
        "sample "
        "(4)");
    add("--rate", options.rate, "R", "steps a second that the network is for (30)");
    add("--force-features", options.force_features, "0|1",
        "forces at x_t and at the guess as input (1)");
    add("--recipe", options.recipe, "NAME",
        "kicks: perturbed states, error of position in the loss; own: goes on from weights of "
        "kicks, on the network's own states; quick; paper: FastClothGNN's (kicks)");
    add("--weights", settings.start_weights, "FILE",
        "start from these weights; a training that is resumed has its own");
    add("--minutes", settings.minutes, "M", "wall time of the training");
    add("--iterations", settings.iterations, "N", "end after so many iterations");
    add("--batch", options.batch, "N",
        "scenes of an iteration, a multiple of the number of processes (that number)");
    add("--processes", options.processes, "N",
        "train with so many on this machine, 1 to 256; on several machines start each with RANK, "
        "WORLD_SIZE, MASTER_ADDR and MASTER_PORT instead (1)");
    add("--pool", settings.pool, "N", "scenes trained on in turn, for each of the batch (40)");
    add("--garment-share", settings.scenes.garment_share, "P",
        "share of garment scenes; 0: sheets alone (0.65)");
    add("--garment", garments, "A,B,...",
        "train on these garments alone: names of data/assets/garments, or files of yours")
        ->delimiter(',')
        ->take_all();
    app.add_flag("--proxies", settings.scenes.proxies,
                 "steps start where a coarse garment of the wardrobe shows the fine one: the "
                 "network learns its detail. Garments that have such a one, no sheets");
    add("--seed", settings.seed, "S", "(1)");
    add("--threads", settings.threads, "N", "for the scenes of a batch, and for validation (1)");
    add("--device", settings.device, "NAME", "cpu or cuda (cpu)");
    add("--nice", options.nice, "N", "lower priority, 0 to 19 (0)");
    add("--out", settings.out, "DIR",
        "checkpoint.pt, weights.safetensors, metrics.csv, rollouts.csv (out/train)");
    add("--save-every", settings.save_every, "M", "minutes between checkpoints (3)");
    app.add_flag("--resume", options.resume, "go on from the checkpoint in DIR");

    const char* const recipe = "Instead of the recipe's";
    add("--loss", options.loss, "NAME", "energy, log or both", recipe);
    for (const cloth::RecipeOption& option : cloth::recipe_options())
        app.add_option_function<double>(
               option.name,
               [&options, &option](double value) { options.recipe_values[option.name] = value; },
               option.description)
            ->type_name(option.type)
            ->group(recipe);

    const char* const validation =
        "Validation, single steps and rollouts in the stepper as it is used";
    add("--validation-every", settings.validate_every, "M", "minutes in between (10)", validation);
    add("--validation-share", settings.validation_share, "P", "of the time at most; 0: none (0.1)",
        validation);
    add("--validation-clips", settings.rollouts.clips, "A,B,...",
        "motions (those of the shared data folder, else 01_01)", validation)
        ->delimiter(',')
        ->take_all();
    add("--validation-garments", settings.rollouts.garments, "A,B,...",
        "of those trained on (tshirt,pants_1000,dress_1000, or those of them that are, or the last "
        "of --garment)",
        validation)
        ->delimiter(',')
        ->take_all();
    add("--validation-frames", settings.rollouts.frames, "N", "of a rollout (90)", validation);
    add("--validation-sheet", settings.rollouts.sheet_vertices, "N",
        "vertices of the sheets; 0: none (1000)", validation);
    add("--references", settings.references, "DIR",
        "where the rollouts' references are kept, which take minutes to compute (references in "
        "--out)",
        validation);
    try {
        app.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error));  // help, or what is wrong
    }
    choose_garments(garments, settings.scenes);
    return options;
}

cloth::ModelConfig model_config(const Options& options) {
    using cloth::ModelConfig;
    const bool is_flat =
        ModelConfig::variant_named(options.variant).pooling == cloth::Pooling::none;
    const int steps = options.steps.value_or(is_flat ? 8 : 15);
    cloth::check_range("--steps", steps, 1, 64);
    if (is_flat && options.levels)
        throw cloth::ArgumentError("--levels", "is for variants with coarse levels",
                                   "take --variant hood, hood_fast or bistride");
    ModelConfig config =
        ModelConfig::variant_named(options.variant, steps, options.levels.value_or(2));
    if (!options.sampled_edges) return config;
    if (config.sampled_edges == 0)
        throw cloth::ArgumentError("--sampled-edges", "is for variants that sample neighbours",
                                   "take --variant sampling, fast or hood_fast");
    cloth::check_range("--sampled-edges", *options.sampled_edges, 1, 32);
    config.sampled_edges = *options.sampled_edges;
    return config;
}

cloth::TrainerSettings make_settings(const Options& options, int processes) {
    cloth::TrainerSettings settings = options.settings;
    settings.batch = options.batch.value_or(processes);
    settings.model = model_config(options);
    settings.model.width = options.width;
    cloth::check_range("--rate", options.rate, 1.0, 10000.0);
    settings.model.dt = 1.0 / options.rate;
    settings.model.features.force_features = options.force_features;
    settings.model = cloth::ModelConfig::from_json(settings.model.to_json(), "command line");
    settings.recipe = cloth::Recipe::named(options.recipe, options.width);
    if (!options.loss.empty()) settings.recipe.loss = cloth::loss_named(options.loss);
    cloth::set_recipe(options.recipe_values, settings.recipe);
    return settings;
}

/// True: this process only watches over those that train.
bool is_launcher(const Options& options) {
    cloth::check_range("--processes", options.processes, 1, 256);
    if (options.processes == 1) return false;
    const char* const size = std::getenv("WORLD_SIZE");
    if (size != nullptr && size != std::to_string(options.processes))
        throw cloth::ArgumentError(
            "--processes",
            "contradicts WORLD_SIZE of the environment, which is " + std::string(size),
            "give --processes on one machine, or WORLD_SIZE on several, not both");
    return size == nullptr;
}

void train(const Options& options) {
    const cloth::ProcessGroup group = cloth::ProcessGroup::from_environment();
    const cloth::TrainingProgram program{"train", options.settings.out, options.nice,
                                         options.resume, group.is_first()};
    cloth::run_training(
        program, [&] { return cloth::Trainer(make_settings(options, group.size()), group); });
}

}  // namespace

int main(int count, char** arguments) {
    try {
        const Options options = parse(count, arguments);
        if (is_launcher(options))
            return cloth::run_local_processes(options.processes, arguments,
                                              cloth::ProcessGroup::free_port());
        train(options);
    } catch (const std::exception& error) {
        std::cerr << "train: " << error.what() << "\n";
        return 1;
    }
    return 0;
}
