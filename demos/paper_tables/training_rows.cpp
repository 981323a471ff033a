#include "demos/paper_tables/training_rows.h"

#include <filesystem>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/make_folder.h"
#include "demos/compare/input_files.h"
#include "demos/compare/json_numbers.h"
#include "demos/train_series/child_process.h"
#include "demos/train_series/metrics_row.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

const std::string smallest = "smallest";
constexpr size_t averaged_rows = 5;

ordered_json number_in(const ordered_json& row, const std::string& column) {
    return row.value(column, ordered_json());
}

ChildResult train(const std::string& network, int iterations, const TrainingRowSettings& settings) {
    const std::string folder = settings.work + "/" + network + "_" + std::to_string(iterations);
    std::filesystem::remove_all(folder);
    make_folder(folder);
    std::vector<std::string> command = {settings.train, "--recipe", "kicks", "--seed", "11"};
    const std::vector<std::string> size =
        network == smallest
            ? std::vector<std::string>{"--variant", "fast", "--width", "16", "--steps", "1"}
            : std::vector<std::string>{
                  "--variant",
                  network,
                  "--width",
                  "32",
                  "--steps",
                  network.rfind("hood", 0) == 0 || network == "bistride" ? "15" : "21"};
    command.insert(command.end(), size.begin(), size.end());
    for (const std::string& argument :
         {std::string("--iterations"), std::to_string(iterations),
          std::string("--validation-share"), std::string("0"), std::string("--out"), folder})
        command.push_back(argument);
    const std::string log = folder + "/train.log";
    const ChildResult child = run_child(command, log);
    if (child.interrupted)
        throw LoadError(log, "", "the training was interrupted", "the same command goes on");
    if (child.status != 0)
        throw LoadError(log, "", "the training ended with status " + std::to_string(child.status),
                        "see the log, or give --no-training");
    return child;
}

ordered_json cost_of(const std::string& network, const TrainingRowSettings& settings) {
    const int less = settings.iterations / 4;
    const ChildResult shorter = train(network, less, settings);
    const ChildResult longer = train(network, settings.iterations, settings);
    const double cost = (longer.processor_s - shorter.processor_s) / (settings.iterations - less);
    return {{"s_per_iteration", rounded_number(cost)}, {"peak_mb", rounded_number(longer.peak_mb)}};
}

std::string metrics_file(const std::string& network, const TrainingRowSettings& settings) {
    const std::string folder = settings.weights.empty() ? asset_path("weights") : settings.weights;
    const std::string file = folder + "/" + network + ".csv";
    return std::filesystem::exists(file) ? file : "";
}

LoadError not_metrics(const std::string& file) {
    return {file, "", "has no iteration in every row and gap_training_median in any",
            "take the metrics.csv of a training"};
}

}  // namespace

ordered_json training_history(const std::string& file) {
    if (file.empty() || !std::filesystem::exists(file)) return nullptr;
    const std::vector<ordered_json> rows = metrics_rows(file);
    ordered_json history = {{"iterations", nullptr},
                            {"gap_tshirt", nullptr},
                            {"gap_sheet", nullptr},
                            {"history", ordered_json::array()}};
    std::vector<double> gaps;
    for (const ordered_json& row : rows) {
        if (!row.contains("iteration")) throw not_metrics(file);
        history["iterations"] = row.at("iteration").get<int>();
        if (row.contains("gap_tshirt_median")) {
            history["gap_tshirt"] = row.at("gap_tshirt_median");
            history["gap_sheet"] = number_in(row, "gap_sheet_median");
        }
        if (!row.contains("gap_training_median")) continue;  // none was measured
        gaps.push_back(row.at("gap_training_median"));
        if (gaps.size() < averaged_rows) continue;
        double sum = 0.0;
        for (size_t k = gaps.size() - averaged_rows; k < gaps.size(); ++k) sum += gaps[k];
        history["history"].push_back({history["iterations"], rounded_number(sum / averaged_rows)});
    }
    if (gaps.empty() && !rows.empty()) throw not_metrics(file);
    return history;
}

void measure_trainings(const std::vector<std::string>& networks,
                       const TrainingRowSettings& settings, PaperReport& report,
                       const ProgressFunction& progress) {
    const bool runs = !settings.train.empty() && std::filesystem::exists(settings.train);
    std::vector<std::string> all = networks;
    all.insert(all.begin(), smallest);
    for (size_t k = 0; k < all.size(); ++k) {
        const std::string file = metrics_file(all[k], settings);
        ordered_json row = {{"network", all[k]},
                            {"key", (runs ? std::to_string(settings.iterations) : "no") +
                                        " iterations, metrics " + fingerprint(file)},
                            {"iterations", nullptr},
                            {"gap_tshirt", nullptr},
                            {"gap_sheet", nullptr},
                            {"history", ordered_json::array()},
                            {"s_per_iteration", nullptr},
                            {"peak_mb", nullptr}};
        if (report.has("training", row, row.at("key"))) continue;
        progress(static_cast<int>(k), static_cast<int>(all.size()), "short trainings: " + all[k]);
        if (const ordered_json history = training_history(file); !history.is_null())
            row.update(history);
        if (runs) row.update(cost_of(all[k], settings));
        report.put("training", row);
    }
}

}  // namespace cloth
