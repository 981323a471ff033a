// Trains a cloth network on the incremental potential.
//
//     train --variant fast --width 32 --minutes 60 --out out/fast
//     train --variant baseline --recipe paper --device cuda --iterations 110000 --out out/baseline

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

#include "data/core/errors.h"
#include "gnn/train/trainer.h"

namespace {

std::atomic<bool> g_stop{false};

void on_signal(int) {
    g_stop = true;
}

struct Options {
    cloth::TrainerSettings settings;
    std::string variant = "fast", recipe = "quick", loss;
    int width = 128, steps = 21;
    bool force_features = true, resume = false;
    double learning_rate = 0.0;
    int heal = 0;
};

Options parse(int count, char** arguments) {
    Options options;
    cloth::TrainerSettings& settings = options.settings;
    std::string garment;
    CLI::App app("train: trains a cloth network on the incremental potential, without ground truth",
                 "train");
    app.option_defaults()->take_last();
    const auto add = [&app](const char* name, auto& value, const char* type,
                            const char* description) {
        app.add_option(name, value, description)->type_name(type);
    };
    add("--variant", options.variant, "NAME", "baseline, sampling, reduction or fast (fast)");
    add("--recipe", options.recipe, "NAME",
        "quick: an hour on a processor core; paper: FastClothGNN's (quick)");
    add("--loss", options.loss, "NAME", "energy, log or both (the recipe's)");
    add("--minutes", settings.minutes, "M", "wall time of the training");
    add("--iterations", settings.iterations, "N", "end after so many iterations");
    add("--width", options.width, "D", "latent size, a multiple of 16 trains fastest (128)");
    add("--steps", options.steps, "L", "message passing steps (21)");
    add("--force-features", options.force_features, "0|1",
        "forces at x_t and at the guess as input (1)");
    add("--learning-rate", options.learning_rate, "R", "(the recipe's)");
    add("--heal", options.heal, "K", "quasi-Newton iterations of a healed state (6)");
    add("--pool", settings.pool, "N", "scenes trained on in turn (40)");
    add("--tshirt-share", settings.scenes.tshirt_share, "P", "share of T-shirt scenes (0.65)");
    add("--garment", garment, "FILE", "train on this T-shirt of data/assets alone");
    add("--seed", settings.seed, "S", "(1)");
    add("--threads", settings.threads, "N", "of LibTorch (1)");
    add("--device", settings.device, "NAME", "cpu or cuda (cpu)");
    add("--validate-every", settings.validate_every, "N", "iterations (500)");
    add("--out", settings.out, "DIR",
        "checkpoint.pt, metrics.csv, weights.safetensors (out/train)");
    app.add_flag("--resume", options.resume, "go on from the checkpoint in DIR");
    try {
        app.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error));  // help, or what is wrong
    }
    if (!garment.empty()) settings.scenes.garments = {garment};
    return options;
}

cloth::TrainerSettings make_settings(const Options& options) {
    cloth::TrainerSettings settings = options.settings;
    settings.model = cloth::ModelConfig::variant_named(options.variant);
    settings.model.width = options.width;
    settings.model.steps = options.steps;
    settings.model.features.force_features = options.force_features;
    settings.model = cloth::ModelConfig::from_json(settings.model.to_json(), "command line");
    settings.recipe = cloth::Recipe::named(options.recipe, options.width);
    if (!options.loss.empty()) settings.recipe.loss = cloth::loss_named(options.loss);
    if (options.learning_rate > 0.0) settings.recipe.base_rate = options.learning_rate;
    if (options.heal > 0) settings.recipe.heal_iterations = options.heal;
    return settings;
}

}  // namespace

int main(int count, char** arguments) {
    try {
        const Options options = parse(count, arguments);
        cloth::Trainer trainer(make_settings(options));
        if (options.resume && !trainer.resume())
            std::cerr << "train: no checkpoint in " << options.settings.out << ", starting anew\n";
        std::signal(SIGINT, on_signal);
        std::signal(SIGTERM, on_signal);
        trainer.run(g_stop);
        std::cerr << "train: weights in " << options.settings.out << "/weights.safetensors\n";
    } catch (const std::exception& error) {
        std::cerr << "train: " << error.what() << "\n";
        return 1;
    }
    return 0;
}
