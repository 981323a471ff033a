// Trains a cloth network on the incremental potential.
//
//     train --variant fast --width 32 --minutes 60 --out out/fast
//     train --variant baseline --recipe paper --device cuda --iterations 110000 --out out/baseline

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

const char* const usage =
    R"(train: trains a cloth network on the incremental potential, without ground truth

  --variant NAME      baseline, sampling, reduction or fast (fast)
  --recipe NAME       quick: an hour on a processor core; paper: FastClothGNN's (quick)
  --loss NAME         energy, log or both (the recipe's)
  --minutes M         wall time of the training
  --iterations N      end after so many iterations
  --width D           latent size, a multiple of 16 trains fastest (128)
  --steps L           message passing steps (21)
  --force-features 0|1  forces at x_t and at the guess as input (1)
  --learning-rate R   (the recipe's)
  --heal K            quasi-Newton iterations of a healed state (6)
  --pool N            scenes trained on in turn (40)
  --tshirt-share P    share of T-shirt scenes (0.65)
  --garment FILE      train on this T-shirt of data/assets alone
  --seed S            (1)
  --threads N         of LibTorch (1)
  --device NAME       cpu or cuda (cpu)
  --validate-every N  iterations (500)
  --out DIR           checkpoint.pt, metrics.csv, weights.safetensors (out/train)
  --resume            go on from the checkpoint in DIR
)";

struct Options {
    cloth::TrainerSettings settings;
    std::string variant = "fast", recipe = "quick", loss;
    int width = 128, steps = 21;
    bool force_features = true, resume = false;
    double learning_rate = 0.0;
    int heal = 0;
};

double to_number(const std::string& name, const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0')
        throw cloth::ArgumentError(name, "'" + text + "' is not a number", "see train --help");
    return value;
}

void set_option(Options& o, const std::string& name, const std::string& text) {
    const auto number = [&] { return to_number(name, text); };
    cloth::TrainerSettings& s = o.settings;
    if (name == "--variant")
        o.variant = text;
    else if (name == "--recipe")
        o.recipe = text;
    else if (name == "--loss")
        o.loss = text;
    else if (name == "--minutes")
        s.minutes = number();
    else if (name == "--iterations")
        s.iterations = static_cast<std::int64_t>(number());
    else if (name == "--width")
        o.width = static_cast<int>(number());
    else if (name == "--steps")
        o.steps = static_cast<int>(number());
    else if (name == "--force-features")
        o.force_features = number() != 0.0;
    else if (name == "--learning-rate")
        o.learning_rate = number();
    else if (name == "--heal")
        o.heal = static_cast<int>(number());
    else if (name == "--pool")
        s.pool = static_cast<int>(number());
    else if (name == "--tshirt-share")
        s.scenes.tshirt_share = number();
    else if (name == "--garment")
        s.scenes.garments = {text};
    else if (name == "--seed")
        s.seed = static_cast<std::uint64_t>(number());
    else if (name == "--threads")
        s.threads = static_cast<int>(number());
    else if (name == "--device")
        s.device = text;
    else if (name == "--validate-every")
        s.validate_every = static_cast<int>(number());
    else if (name == "--out")
        s.out = text;
    else
        throw cloth::ArgumentError(name, "is not an option", "see train --help");
}

Options parse(int count, char** arguments) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string name = arguments[i];
        if (name == "--help") {
            std::cout << usage;
            std::exit(0);
        }
        if (name == "--resume") {
            options.resume = true;
            continue;
        }
        if (i + 1 == count) throw cloth::ArgumentError(name, "has no value", "see train --help");
        set_option(options, name, arguments[++i]);
    }
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
