#include "demos/hard_cases/hard_row.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

double highest(const std::vector<double>& values) {
    return quantile(values, 1.0);
}

HardRow bare_row(const HardCase& hard, const std::string& stepper, int frames_wanted) {
    HardRow row;
    row.hard_case = hard.name;
    row.stepper = stepper;
    row.penetration_bound_mm = hard.bounds.penetration_mm;
    row.stretch_bound = hard.bounds.stretch_p99.value_or(HardRow::unknown);
    row.frames_wanted = frames_wanted;
    return row;
}

/// Four decimals, which is more than any figure here is worth; null for what is not finite.
ordered_json rounded(double value) {
    return json_number(std::round(1e4 * value) / 1e4);
}

double number(const ordered_json& value) {
    return value.is_null() ? HardRow::unknown : value.get<double>();
}

std::string starts_held(const HardRow& row) {
    return std::to_string(row.starts_held) + " of " + std::to_string(row.starts) + " starts";
}

std::string verdict(const HardRow& row) {
    if (!row.held) return "not run";
    return *row.held ? "held" : "FAILED";
}

}  // namespace

HardRow make_row(const HardCase& hard, const std::string& stepper, const HardRun& run,
                 int frames_wanted) {
    HardRow row = bare_row(hard, stepper, frames_wanted);
    row.held = run.held();
    row.finite = run.finite;
    row.penetration_max_mm = highest(run.penetration_mm);
    row.surface_max_mm = highest(run.surface_mm);
    row.stretch_p99 = highest(run.stretch_p99);
    if (!run.stretch_p99.empty()) row.end_stretch_p99 = run.stretch_p99.back();
    row.rest_jitter_mm = run.rest_jitter_mm.value_or(HardRow::unknown);
    row.rms_speed_max = highest(run.rms_speed);
    row.first_failed_frame = run.first_failed_frame;
    row.failure = run.failure;
    row.ms_median = median(run.ms);
    if (run.ms.size() > 1) {
        const std::vector<double> later(run.ms.begin() + 1, run.ms.end());
        row.ms_p95 = quantile(later, 0.95);
        row.ms_longest = highest(later);
    }
    row.frames = run.frames;
    row.starts_held = run.held() ? 1 : 0;
    return row;
}

HardRow skipped_row(const HardCase& hard, const std::string& stepper, const std::string& reason,
                    int frames_wanted) {
    HardRow row = bare_row(hard, stepper, frames_wanted);
    row.failure = reason;
    return row;
}

HardRow refused_row(const HardCase& hard, const std::string& stepper, const std::string& error,
                    int frames_wanted) {
    HardRow row = skipped_row(hard, stepper, "refused: " + error, frames_wanted);
    row.held = false;
    row.first_failed_frame = 0;
    return row;
}

ordered_json to_json(const HardRow& row) {
    ordered_json json;
    json["case"] = row.hard_case;
    json["stepper"] = row.stepper;
    if (!row.inputs.empty()) json["inputs"] = row.inputs;
    json["held"] = row.held ? ordered_json(*row.held) : ordered_json();
    json["finite"] = row.finite;
    json["penetration_max_mm"] = rounded(row.penetration_max_mm);
    json["penetration_bound_mm"] = rounded(row.penetration_bound_mm);
    json["surface_max_mm"] = rounded(row.surface_max_mm);
    json["stretch_p99"] = rounded(row.stretch_p99);
    json["stretch_bound"] = rounded(row.stretch_bound);
    json["end_stretch_p99"] = rounded(row.end_stretch_p99);
    json["rest_jitter_mm"] = rounded(row.rest_jitter_mm);
    json["rms_speed_max"] = rounded(row.rms_speed_max);
    json["first_failed_frame"] =
        row.first_failed_frame ? ordered_json(*row.first_failed_frame) : ordered_json();
    json["failure"] = row.failure.empty() ? ordered_json() : ordered_json(row.failure);
    json["ms_median"] = rounded(row.ms_median);
    json["ms_p95"] = rounded(row.ms_p95);
    json["ms_longest"] = rounded(row.ms_longest);
    json["frames"] = row.frames;
    json["frames_wanted"] = row.frames_wanted;
    json["starts"] = row.starts;
    json["starts_held"] = row.starts_held;
    return json;
}

HardRow row_from_json(const ordered_json& json) {
    HardRow row;
    row.hard_case = json.at("case").get<std::string>();
    row.stepper = json.at("stepper").get<std::string>();
    row.inputs = json.value("inputs", "");
    if (!json.at("held").is_null()) row.held = json.at("held").get<bool>();
    row.finite = json.at("finite").get<bool>();
    row.penetration_max_mm = number(json.at("penetration_max_mm"));
    row.penetration_bound_mm = number(json.at("penetration_bound_mm"));
    row.surface_max_mm = number(json.at("surface_max_mm"));
    row.stretch_p99 = number(json.at("stretch_p99"));
    row.stretch_bound = number(json.at("stretch_bound"));
    row.end_stretch_p99 = number(json.at("end_stretch_p99"));
    row.rest_jitter_mm = number(json.at("rest_jitter_mm"));
    row.rms_speed_max = number(json.at("rms_speed_max"));
    if (!json.at("first_failed_frame").is_null())
        row.first_failed_frame = json.at("first_failed_frame").get<int>();
    if (!json.at("failure").is_null()) row.failure = json.at("failure").get<std::string>();
    row.ms_median = number(json.at("ms_median"));
    row.ms_p95 = number(json.at("ms_p95"));
    row.ms_longest = number(json.at("ms_longest"));
    row.frames = json.at("frames").get<int>();
    row.frames_wanted = json.at("frames_wanted").get<int>();
    row.starts = json.at("starts").get<int>();
    row.starts_held = json.at("starts_held").get<int>();
    return row;
}

std::string text_line(const HardRow& row) {
    char line[256];
    std::snprintf(line, sizeof line, "%-20s %-16s %-7s  %7.2f mm inside  stretch %6.3f  %8.1f ms",
                  row.hard_case.c_str(), row.stepper.c_str(), verdict(row).c_str(),
                  row.penetration_max_mm, row.stretch_p99, row.ms_median);
    std::string text = line;
    if (row.starts > 1) text += "  held from " + starts_held(row);
    if (row.failure.empty()) return text;
    if (row.first_failed_frame) text += "  frame " + std::to_string(*row.first_failed_frame) + ":";
    return text + " " + row.failure;
}

std::string markdown(const std::vector<HardRow>& rows) {
    std::vector<std::string> cases, steppers;
    const auto collect = [](std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const HardRow& row : rows) {
        collect(cases, row.hard_case);
        collect(steppers, row.stepper);
    }
    std::string table = "| case |", line = "|---|";
    for (const std::string& stepper : steppers) {
        table += " " + stepper + " |";
        line += "---|";
    }
    table += "\n" + line + "\n";
    for (const std::string& one : cases) {
        table += "| " + one + " |";
        for (const std::string& stepper : steppers) {
            const auto row = std::find_if(rows.begin(), rows.end(), [&](const HardRow& r) {
                return r.hard_case == one && r.stepper == stepper;
            });
            if (row == rows.end()) {
                table += " |";
                continue;
            }
            table +=
                !row->held || *row->held
                    ? " " + verdict(*row)
                    : " frame " + std::to_string(*row->first_failed_frame) + ": " + row->failure;
            if (row->held && row->starts > 1) table += " (held from " + starts_held(*row) + ")";
            table += " |";
        }
        table += "\n";
    }
    return table;
}

}  // namespace cloth
