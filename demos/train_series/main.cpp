// train_series: several trainings that differ in one thing, one after another. See --help.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "data/files/make_folder.h"
#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"
#include "demos/train_series/series_run.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

struct Options {
    bool list = false;
    std::string series = "states", out = "out/train_series";
    SeriesSettings settings;
};

Options parse_options(const std::vector<std::string>& arguments) {
    Options options;
    SeriesSettings& settings = options.settings;
    settings.train =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "train").string();
    settings.trainings = "out/trainings";
    std::vector<std::string> seeds;
    CLI::App app("train_series: trainings of equal length that differ in one thing",
                 "train_series");
    set_up(app);
    app.add_flag("--list", options.list, "name the series and their trainings");
    app.add_option("--series", options.series, "states (default), variants or neighbours")
        ->type_name("NAME");
    add_list(app, "--only", settings.only, "trainings of the series (default: all)");
    add_whole_number(app, "--iterations", settings.iterations, 1, 10000000,
                     "of each training (default: the series' own)");
    add_list(app, "--seeds", seeds, "each training is run with each (default 1,2)");
    app.add_option("--train", settings.train, "the program train (default: beside this one)")
        ->type_name("FILE");
    app.add_option("--trainings", settings.trainings,
                   "folder of the trainings (default out/trainings): what is there\n"
                   "is not trained again, and what was interrupted goes on")
        ->type_name("DIR");
    app.add_option("--out", options.out, "where train_series.json goes")->type_name("DIR");
    app.add_option("arguments", settings.arguments, "after --: more arguments of train");
    parse(app, arguments);
    if (!seeds.empty()) settings.seeds.clear();
    for (const std::string& seed : seeds)
        settings.seeds.push_back(whole_number("--seeds", seed, 0, 1000000));
    return options;
}

void run(const Options& options) {
    if (options.list) {
        for (const TrainingSeries& series : training_series()) {
            std::printf("%s: %s, %d iterations\n", series.name.c_str(), series.sentence.c_str(),
                        series.iterations);
            for (const SeriesTraining& one : series.trainings)
                std::printf("  %-14s %s\n", one.name.c_str(), one.meaning.c_str());
        }
        return;
    }
    const TrainingSeries& series = training_series(options.series);
    const auto say = [](const std::string& line) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
    };
    make_folder(options.out);
    const nlohmann::ordered_json report = run_series(series, options.settings, say);
    write_text_file(options.out + "/train_series.json", report.dump(1) + "\n");
    std::printf("%s/train_series.json\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        run(parse_options(arguments));
    });
}
