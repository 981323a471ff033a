#include "demos/scaling/scaling_row.h"

#include <algorithm>
#include <cstddef>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"
#include "render/plot.h"

namespace cloth {
namespace {

std::vector<double> after(const std::vector<double>& values, int warm_up) {
    const auto skipped =
        std::min(static_cast<std::ptrdiff_t>(values.size()), static_cast<std::ptrdiff_t>(warm_up));
    return {values.begin() + skipped, values.end()};
}

/// The place of a name in the list, which gets it if it has it not.
size_t place_of(const std::string& name, std::vector<std::string>& names) {
    const auto at = std::find(names.begin(), names.end(), name);
    const auto place = static_cast<size_t>(at - names.begin());
    if (at == names.end()) names.push_back(name);
    return place;
}

}  // namespace

ScalingRow make_scaling_row(const Rollout& rollout, int warm_up) {
    const auto typical = [&](const std::vector<double>& ms) { return median(after(ms, warm_up)); };
    ScalingRow row;
    row.frames = static_cast<int>(after(rollout.ms, warm_up).size());
    row.ms_median = typical(rollout.ms);
    row.ms_p95 = quantile(after(rollout.ms, warm_up), 0.95);
    row.proximity_ms = typical(rollout.proximity);
    row.features_ms = typical(rollout.features);
    row.solve_ms = typical(rollout.solve);
    row.contact_ms = typical(rollout.contact);
    row.failure = rollout.failure;
    return row;
}

nlohmann::ordered_json to_json(const ScalingRow& row) {
    nlohmann::ordered_json json;
    json["scene"] = row.scene;
    json["vertices"] = row.vertices;
    json["solver"] = row.solver;
    json["frames"] = row.frames;
    json["ms_median"] = rounded_number(row.ms_median);
    json["ms_p95"] = rounded_number(row.ms_p95);
    json["us_per_vertex"] = rounded_number(row.us_per_vertex());
    json["stages_ms"] = {{"proximity", rounded_number(row.proximity_ms)},
                         {"features", rounded_number(row.features_ms)},
                         {"solve", rounded_number(row.solve_ms)},
                         {"contact", rounded_number(row.contact_ms)}};
    json["setup_ms"] = rounded_number(row.setup_ms);
    json["memory_mb"] = rounded_number(row.memory_mb);
    json["failure"] =
        row.failure.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(row.failure);
    return json;
}

std::string scaling_plot(const std::vector<ScalingRow>& rows, int threads) {
    std::vector<std::string> scenes, solvers, lines;
    std::vector<Series> series;
    for (const ScalingRow& row : rows) {
        const size_t scene = place_of(row.scene, scenes), solver = place_of(row.solver, solvers);
        const size_t line = place_of(row.scene + ": " + row.solver, lines);
        if (line == series.size()) {
            series.push_back({lines.back()});
            series.back().style = SeriesStyle::line_and_points;
            series.back().colour = category_colour(static_cast<int>(solver));
            series.back().dashed = scene > 0;
        }
        series[line].x.push_back(row.vertices);
        series[line].y.push_back(row.us_per_vertex());
    }
    PlotSettings settings;
    settings.title = "time of a frame of 1/30 s, per vertex";
    settings.x_label = "vertices";
    settings.y_label =
        "us (median), " + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
    settings.x_scale = Scale::logarithmic;
    return plot_svg(series, settings);
}

}  // namespace cloth
