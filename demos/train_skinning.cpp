// Trains a garment-specific skinning network on the incremental potential: a peer of the networks
// that `train` makes, for one garment on the default body.
//
//     train_skinning --garment tshirt_1000 --minutes 40 --out out/skinning

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <string>

#include "demos/training_program.h"
#include "gnn/train/skinning_trainer.h"

namespace {

struct Options {
    cloth::SkinningTrainerSettings settings;
    std::string loss = "log";
    int nice = 0;
    bool resume = false;
};

Options parse(int count, char** arguments) {
    Options options;
    cloth::SkinningTrainerSettings& settings = options.settings;
    CLI::App app("train_skinning: trains a garment-specific skinning network, without ground truth",
                 "train_skinning");
    app.option_defaults()->take_last();
    const auto add = [&app](const char* name, auto& value, const char* type,
                            const char* description) {
        return app.add_option(name, value, description)->type_name(type);
    };
    add("--garment", settings.garment, "NAME",
        "a name of data/assets/garments, or a file (tshirt_1000)");
    add("--motions", settings.motions, "A,B,...",
        "to train on (those of the shared data folder, else 01_03 and Boxing_Toes)")
        ->delimiter(',')
        ->take_all();
    add("--validation-motion", settings.validation_motion, "NAME", "not trained on (01_01)");
    add("--layers", settings.model.layers, "A,B,...",
        "widths of the hidden layers; the last is the number of shapes that are mixed "
        "(256,192,128)")
        ->delimiter(',')
        ->take_all();
    add("--ages", settings.model.ages, "A,B,...",
        "steps before its end of the poses that a step sees (0,1,2,4,8)")
        ->delimiter(',')
        ->take_all();
    add("--loss", options.loss, "NAME", "energy or log (log)");
    add("--learning-rate", settings.learning_rate, "R", "(1e-3)");
    add("--sequences", settings.sequences, "N", "of an iteration (4)");
    add("--frames", settings.frames, "N", "of a sequence (4)");
    add("--minutes", settings.minutes, "M", "wall time of the training");
    add("--iterations", settings.iterations, "N", "end after so many iterations");
    add("--seed", settings.seed, "S", "(1)");
    add("--threads", settings.threads, "N", "of LibTorch (1)");
    add("--nice", options.nice, "N", "lower priority, 0 to 19 (0)");
    add("--validate-every", settings.validate_every, "N", "iterations; 0: never (500)");
    add("--save-every", settings.save_every, "M", "minutes between checkpoints (3)");
    add("--out", settings.out, "DIR",
        "checkpoint.pt, weights.safetensors, metrics.csv (out/skinning)");
    app.add_flag("--resume", options.resume, "go on from the checkpoint in DIR");
    try {
        app.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error));  // help, or what is wrong
    }
    settings.loss = cloth::loss_named(options.loss);
    return options;
}

}  // namespace

int main(int count, char** arguments) {
    try {
        const Options options = parse(count, arguments);
        const cloth::TrainingProgram program{"train_skinning", options.settings.out, options.nice,
                                             options.resume};
        cloth::run_training(program, [&] { return cloth::SkinningTrainer(options.settings); });
    } catch (const std::exception& error) {
        std::cerr << "train_skinning: " << error.what() << "\n";
        return 1;
    }
    return 0;
}
