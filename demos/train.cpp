// Trains a cloth network on the incremental potential.
//
//     train --iterations 250000 --out out/kicks
//     train --variant baseline --recipe paper --width 128 --steps 21 --device cuda
//           --iterations 110000 --out out/baseline

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/train/trainer.h"

namespace {

std::atomic<bool> g_stop{false};

/// The first asks for a checkpoint and an end, the second ends the program at once.
void on_signal(int signal) {
    g_stop = true;
    std::signal(signal, SIG_DFL);
}

const char* const usage =
    R"(train: trains a cloth network on the incremental potential, without ground truth

  --variant NAME      baseline, sampling, reduction or fast (fast)
  --width D           latent size, a multiple of 16 trains fastest (32)
  --steps L           message passing steps (8)
  --force-features 0|1  forces at x_t and at the guess as input (1)
  --recipe NAME       kicks: perturbed states, error of position in the loss; own: goes on from
                      weights of kicks, on the network's own states; quick; paper: FastClothGNN's
                      (kicks)
  --weights FILE      start from these weights
  --minutes M         wall time of the training
  --iterations N      end after so many iterations
  --pool N            scenes trained on in turn (40)
  --tshirt-share P    share of T-shirt scenes (0.65)
  --garment FILE      train on this T-shirt of data/assets alone
  --seed S            (1)
  --threads N         of LibTorch (1)
  --device NAME       cpu or cuda (cpu)
  --nice N            lower priority, 0 to 19 (0)
  --out DIR           checkpoint.pt, weights.safetensors, metrics.csv, rollouts.csv (out/train)
  --save-every M      minutes between checkpoints (3)
  --resume            go on from the checkpoint in DIR

Instead of the recipe's:
  --learning-rate R
  --loss NAME         energy, log or both
  --position-weight W   of the error of position in the loss
  --target-iterations K  quasi-Newton iterations to the target of the loss, a healed state too
  --loss-iterations K   quasi-Newton iterations between the network's answer and the loss
  --heal K            quasi-Newton iterations of warm-up frames
  --healed-first P, --healed-last P  share of next states that are the solver's, at both ends
  --own-refined P     share of the network's own next states that iterations refine
  --own-iterations K  these iterations
  --kicks P           share of the iterations that perturb their scene
  --skinned P         share of T-shirt scenes that start posed with the body in the midst of a
                      motion
  --skinned-at-rest P   share of these that start without velocity
  --skinned-noise M   noise of their positions (m)
  --noise M           noise of positions, for single steps (m)
  --rollout N         steps of the network from its own states in an iteration

Validation, single steps and rollouts in the stepper as it is used:
  --validation-every M  minutes in between (10)
  --validation-share P  of the time at most; 0: none (0.1)
  --validation-clips A,B,...  motions (those of the shared data folder, else 01_01)
  --validation-frames N  of a rollout (90)
  --validation-sheet N  vertices of the sheets; 0: none (1000)
  --references DIR    where the rollouts' references are kept, which take minutes to compute
                      (references in --out)
)";

struct Options {
    cloth::TrainerSettings settings;
    std::string variant = "fast", recipe = "kicks", loss;
    int width = 32, steps = 8, nice = 0;
    bool force_features = true, resume = false;
    std::map<std::string, double> recipe_values;  ///< of recipe_options
};

using cloth::Recipe;

struct RecipeOption {
    const char* name;
    void (*set)(Recipe&, double);
};

const RecipeOption recipe_options[] = {
    {"--learning-rate", [](Recipe& r, double v) { r.base_rate = v; }},
    {"--position-weight", [](Recipe& r, double v) { r.position_weight = v; }},
    {"--target-iterations", [](Recipe& r, double v) { r.target_iterations = static_cast<int>(v); }},
    {"--loss-iterations", [](Recipe& r, double v) { r.loss_iterations = static_cast<int>(v); }},
    {"--heal", [](Recipe& r, double v) { r.heal_iterations = static_cast<int>(v); }},
    {"--healed-first", [](Recipe& r, double v) { r.heal_first = v; }},
    {"--healed-last", [](Recipe& r, double v) { r.heal_last = v; }},
    {"--own-refined", [](Recipe& r, double v) { r.own_refined = v; }},
    {"--own-iterations", [](Recipe& r, double v) { r.own_iterations = static_cast<int>(v); }},
    {"--kicks", [](Recipe& r, double v) { r.kicks.share = v; }},
    {"--skinned", [](Recipe& r, double v) { r.skinned.share = v; }},
    {"--skinned-at-rest", [](Recipe& r, double v) { r.skinned.at_rest = v; }},
    {"--skinned-noise", [](Recipe& r, double v) { r.skinned.noise = v; }},
    {"--noise", [](Recipe& r, double v) { r.noise = v; }},
    {"--rollout", [](Recipe& r, double v) { r.max_rollout = static_cast<int>(v); }},
};

bool is_recipe_option(const std::string& name) {
    return std::any_of(std::begin(recipe_options), std::end(recipe_options),
                       [&](const RecipeOption& option) { return option.name == name; });
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

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
    else if (is_recipe_option(name))
        o.recipe_values[name] = number();
    else if (name == "--weights")
        s.start_weights = text;
    else if (name == "--nice")
        o.nice = static_cast<int>(number());
    else if (name == "--save-every")
        s.save_every = number();
    else if (name == "--validation-share")
        s.validation_share = number();
    else if (name == "--validation-clips")
        s.rollouts.clips = split(text);
    else if (name == "--validation-frames")
        s.rollouts.frames = static_cast<int>(number());
    else if (name == "--validation-sheet")
        s.rollouts.sheet_vertices = static_cast<int>(number());
    else if (name == "--references")
        s.references = text;
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
    else if (name == "--validation-every")
        s.validate_every = number();
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
    for (const RecipeOption& option : recipe_options) {
        const auto given = options.recipe_values.find(option.name);
        if (given != options.recipe_values.end()) option.set(settings.recipe, given->second);
    }
    return settings;
}

void lower_priority(int nice_value) {
    cloth::check_range("--nice", nice_value, 0, 19);
    if (nice_value > 0 && setpriority(PRIO_PROCESS, 0, nice_value) != 0)
        std::cerr << "train: the priority stays as it is: " << std::strerror(errno) << "\n";
}

/// A training of days must not be lost because an option was forgotten.
void refuse_to_overwrite(const std::string& folder) {
    if (std::filesystem::exists(folder + "/checkpoint.pt"))
        throw cloth::ArgumentError(folder, "has a training already",
                                   "give --resume to go on with it, or another --out");
}

}  // namespace

int main(int count, char** arguments) {
    try {
        const Options options = parse(count, arguments);
        if (!options.resume) refuse_to_overwrite(options.settings.out);
        lower_priority(options.nice);
        cloth::Trainer trainer(make_settings(options));
        if (options.resume && !trainer.resume())
            std::cerr << "train: no checkpoint in " << options.settings.out << ", starting anew\n";
        std::signal(SIGINT, on_signal);
        std::signal(SIGTERM, on_signal);
        trainer.run(g_stop);
        if (g_stop) std::cerr << "train: stopped; --resume goes on\n";
        std::cerr << "train: weights in " << options.settings.out << "/weights.safetensors\n";
    } catch (const std::exception& error) {
        std::cerr << "train: " << error.what() << "\n";
        return 1;
    }
    return 0;
}
