#include "demos/speed_error/solver_row.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"

namespace cloth {
namespace {

using nlohmann::ordered_json;

/// Median over the frames that both have.
double median_ratio(const std::vector<double>& times, const std::vector<double>& others) {
    std::vector<double> ratios;
    for (size_t frame = 0; frame < std::min(times.size(), others.size()); ++frame)
        ratios.push_back(times[frame] / others[frame]);
    return median(ratios);
}

std::string six_digits(double value) {
    std::array<char, 32> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
    return {text.data(), end.ptr};
}

/// A value as a field of a table: texts with commas or quotes are quoted.
std::string field(const ordered_json& value) {
    if (value.is_null()) return "";
    if (value.is_number_float()) return six_digits(value.get<double>());
    if (!value.is_string()) return value.dump();
    std::string text = value.get<std::string>();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    for (size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
        text.insert(at, 1, '"');
    return '"' + text + '"';
}

}  // namespace

SolverRow make_row(const std::string& solver, const ContestResult& result,
                   const std::vector<double>& relative_to) {
    const Rollout& rollout = result.rollout;
    SolverRow row;
    row.solver = solver;
    row.frames = static_cast<int>(rollout.ms.size());
    row.ms_median = median(rollout.ms);
    row.ms_p95 = quantile(rollout.ms, 0.95);
    row.ms_longest = quantile(rollout.ms, 1.0);
    row.ms_ratio = median_ratio(rollout.ms, relative_to);
    row.gap_median = median(result.single.gap);
    row.progress_median = median(result.single.progress);
    row.rmse_mm = mean_of_known(result.single.rmse);
    row.rollout_rmse_mm = mean_of_known(rollout.error);
    row.fine_rmse_mm = mean_of_known(rollout.fine_error);
    row.stretch_p99 = median(rollout.stretch_p99);
    row.penetration_max_mm = quantile(rollout.penetration, 1.0);
    row.finite = rollout.finite;
    row.failure = rollout.failure;
    row.first_failed_frame = rollout.first_failed_frame;
    return row;
}

ordered_json to_json(const SolverRow& row) {
    const bool network = row.network.has_value();
    const bool failed = row.first_failed_frame.has_value();
    ordered_json json;
    json["scene"] = row.scene;
    json["fabric"] = row.fabric;
    json["solver"] = row.solver;
    json["backend"] = network ? ordered_json(row.network->backend) : ordered_json();
    json["width"] = network ? ordered_json(row.network->width) : ordered_json();
    json["refine"] =
        network && row.network->refine ? ordered_json(*row.network->refine) : ordered_json();
    json["threads"] = row.threads;
    json["frames"] = row.frames;
    json["ms_median"] = rounded_number(row.ms_median);
    json["ms_p95"] = rounded_number(row.ms_p95);
    json["ms_longest"] = rounded_number(row.ms_longest);
    json["ms_ratio"] = rounded_number(row.ms_ratio);
    json["gap_median"] = rounded_number(row.gap_median);
    json["progress_median"] = rounded_number(row.progress_median);
    json["rmse_mm"] = rounded_number(row.rmse_mm);
    json["rollout_rmse_mm"] = rounded_number(row.rollout_rmse_mm);
    json["fine_rmse_mm"] = rounded_number(row.fine_rmse_mm);
    json["stretch_p99"] = rounded_number(row.stretch_p99);
    json["penetration_max_mm"] = rounded_number(row.penetration_max_mm);
    json["peak_memory_mb"] = rounded_number(row.peak_memory_mb);
    json["finite"] = row.finite;
    json["first_failed_frame"] = failed ? ordered_json(*row.first_failed_frame) : ordered_json();
    json["failure"] = failed ? ordered_json(row.failure) : ordered_json();
    return json;
}

std::string to_csv(const std::vector<SolverRow>& rows) {
    const ordered_json heading = to_json(SolverRow{});
    std::string table;
    for (const auto& [name, value] : heading.items()) table += (table.empty() ? "" : ",") + name;
    table += '\n';
    for (const SolverRow& row : rows) {
        const ordered_json values = to_json(row);
        std::string line;
        for (const auto& [name, value] : values.items())
            line += (name == "scene" ? "" : ",") + field(value);
        table += line + '\n';
    }
    return table;
}

}  // namespace cloth
