#include "demos/train_series/series_run.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/make_folder.h"
#include "demos/compare/arguments.h"
#include "demos/provenance/provenance.h"
#include "demos/train_series/child_process.h"
#include "demos/train_series/metrics_row.h"
#include "render/replaced_file.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

/// One training with one seed.
struct Job {
    const SeriesTraining* training;
    int seed;
    std::string folder;
    std::vector<std::string> arguments;  ///< of `train`, without those that say where and how long
};

std::string folder_name(const std::string& name, int seed) {
    std::string folder;
    for (const char c : name)
        if (c != '\'') folder += c == ' ' ? '_' : c;
    return folder + "_" + std::to_string(seed);
}

std::vector<Job> jobs_of(const TrainingSeries& series, const SeriesSettings& settings) {
    for (const std::string& name : settings.only)
        if (std::none_of(series.trainings.begin(), series.trainings.end(),
                         [&](const SeriesTraining& one) { return one.name == name; }))
            throw ArgumentError("training '" + name + "'", "is not one of series " + series.name,
                                "see --list");
    std::vector<Job> jobs;
    for (const int seed : settings.seeds)
        for (const SeriesTraining& training : series.trainings) {
            if (!settings.only.empty() &&
                std::count(settings.only.begin(), settings.only.end(), training.name) == 0)
                continue;
            std::vector<std::string> arguments = series.arguments;
            for (const auto& more : {training.arguments, settings.arguments})
                arguments.insert(arguments.end(), more.begin(), more.end());
            jobs.push_back(
                {&training, seed,
                 settings.trainings + "/" + series.name + "/" + folder_name(training.name, seed),
                 arguments});
        }
    return jobs;
}

/// What a finished training has left; null: there is none of the same arguments and length.
ordered_json finished(const Job& job, int iterations) {
    const std::string path = job.folder + "/row.json";
    if (!std::filesystem::exists(path)) return nullptr;
    const ordered_json row = ordered_json::parse(read_file(path), nullptr, false);
    if (row.is_discarded() || row.value("arguments", "") != join_list(job.arguments, " ") ||
        row.value("iteration", 0) != iterations)
        throw LoadError(path, "", "is of another training",
                        "delete its folder, or give another --trainings");
    return row;
}

ordered_json train(const Job& job, int iterations, const SeriesSettings& settings) {
    make_folder(job.folder);
    const std::string log = job.folder + "/train.log";
    const bool goes_on = std::filesystem::exists(job.folder + "/checkpoint.pt");
    std::vector<std::string> command = {settings.train};
    command.insert(command.end(), job.arguments.begin(), job.arguments.end());
    for (const std::string& argument :
         {std::string("--seed"), std::to_string(job.seed), std::string("--iterations"),
          std::to_string(iterations), std::string("--validation-every"), std::string("10000"),
          std::string("--references"), settings.trainings + "/references", std::string("--out"),
          job.folder})
        command.push_back(argument);
    // One that was ended before its first checkpoint has left metrics, and begins anew.
    if (goes_on || std::filesystem::exists(job.folder + "/metrics.csv"))
        command.push_back("--resume");
    const ChildResult child = run_child(command, log);
    if (child.interrupted)
        throw LoadError(log, "", "the training was interrupted", "the same command goes on");
    const ordered_json metrics = last_metrics_row(job.folder + "/metrics.csv");
    if (child.status != 0 || metrics.value("iteration", 0) != iterations)
        throw LoadError(log, "",
                        "the training ended early, with status " + std::to_string(child.status),
                        "see the log; the same command goes on");
    ordered_json row = {{"name", job.training->name},
                        {"meaning", job.training->meaning},
                        {"arguments", join_list(job.arguments, " ")},
                        {"seed", job.seed},
                        {"provenance", provenance_json(1)},
                        {"processor_s", goes_on ? ordered_json() : ordered_json(child.processor_s)},
                        {"peak_mb", child.peak_mb}};
    row.update(metrics);
    write_text_file(job.folder + "/row.json", row.dump(1) + "\n");
    return row;
}

}  // namespace

ordered_json run_series(const TrainingSeries& series, const SeriesSettings& settings,
                        const std::function<void(const std::string&)>& say) {
    if (settings.seeds.empty())
        throw ArgumentError("SeriesSettings.seeds", "is empty", "give one seed at least");
    check_range("SeriesSettings.iterations", settings.iterations, 0, 10000000);
    const int iterations = settings.iterations > 0 ? settings.iterations : series.iterations;
    const std::vector<Job> jobs = jobs_of(series, settings);
    ordered_json report = {{"provenance", ordered_json()},
                           {"series", series.name},
                           {"iterations", iterations},
                           {"rows", ordered_json::array()}};
    for (size_t k = 0; k < jobs.size(); ++k) {
        const std::string what = std::to_string(k + 1) + " of " + std::to_string(jobs.size()) +
                                 ": " + jobs[k].training->name + ", seed " +
                                 std::to_string(jobs[k].seed);
        ordered_json row = finished(jobs[k], iterations);
        if (row.is_null()) {
            say(what + ": trains, see " + jobs[k].folder + "/train.log");
            row = train(jobs[k], iterations, settings);
        } else {
            say(what + ": done before");
        }
        report["rows"].push_back(row);
    }
    report["provenance"] = report["rows"].front()["provenance"];
    return report;
}

}  // namespace cloth
