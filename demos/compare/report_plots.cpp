#include "demos/compare/report_plots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "demos/compare/report_table.h"
#include "render/plot.h"

namespace cloth {

namespace {

using nlohmann::json;

/// A list of numbers of a solver's entry, null as NaN; empty where it is missing.
std::vector<double> numbers_at(const json& solver, const std::string& path) {
    const json::json_pointer pointer(path);
    std::vector<double> values;
    if (!solver.contains(pointer) || !solver.at(pointer).is_array()) return values;
    for (const json& value : solver.at(pointer))
        values.push_back(value.is_number() ? value.get<double>()
                                           : std::numeric_limits<double>::quiet_NaN());
    return values;
}

/// Whether the values span so much that a linear axis would hide the smallest series.
bool spans_decades(const std::vector<Series>& series) {
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    for (const Series& s : series) {
        std::vector<double> values;
        for (double value : s.y)
            if (value > 0.0) values.push_back(value);
        if (values.empty()) continue;
        std::sort(values.begin(), values.end());
        low = std::min(low, values[values.size() / 2]);
        high = std::max(high, values.back());
    }
    return high > 30.0 * low;
}

bool has_values(const std::vector<Series>& series) {
    for (const Series& s : series)
        for (double value : s.y)
            if (std::isfinite(value)) return true;
    return false;
}

std::string figure_html(const std::vector<Series>& series, const PlotSettings& settings,
                        const std::string& caption) {
    if (!has_values(series)) return "";
    return "<figure>\n" + plot_svg(series, settings) + "<figcaption>" + escaped(caption) +
           "</figcaption></figure>\n";
}

/// One line per solver over the time of the motion.
std::string per_frame_html(const json& report, const std::string& path, const std::string& title,
                           const std::string& y_label, const std::string& caption,
                           bool y_from_zero = true) {
    const double dt = report.at("scene").value("time_step", 1.0 / 30.0);
    std::vector<Series> series;
    int k = 0;
    for (const json& solver : report.at("solvers")) {
        Series line;
        line.name = solver.value("name", "?");
        line.colour = category_colour(k);
        line.dashed = k++ >= 8;
        line.y = numbers_at(solver, path);
        for (std::size_t i = 0; i < line.y.size(); ++i)
            line.x.push_back(dt * static_cast<double>(i + 1));
        if (has_values({line})) series.push_back(line);
    }
    PlotSettings settings;
    settings.title = title;
    settings.x_label = "time of the motion (s)";
    settings.y_label = y_label;
    settings.y_scale = spans_decades(series) ? Scale::logarithmic : Scale::linear;
    settings.y_from_zero = y_from_zero;
    return figure_html(series, settings, caption);
}

/// Where each solver stands between fast and right.
std::string speed_error_html(const json& report) {
    std::vector<Series> series;
    int k = 0;
    for (const json& solver : report.at("solvers")) {
        Series point;
        point.style = SeriesStyle::points;
        point.colour = category_colour(k++);
        point.x = {number_at(solver, "/ms_per_frame/median")};
        point.y = {number_at(solver, "/rollout/fine_rmse_mm")};
        point.texts = {solver.value("name", "?")};
        if (std::isfinite(point.x[0]) && std::isfinite(point.y[0])) series.push_back(point);
    }
    PlotSettings settings;
    settings.title = "Time against error";
    settings.x_label = "time per frame (ms, median)";
    settings.y_label = "error to the fine reference (mm)";
    settings.x_scale = Scale::logarithmic;
    settings.y_scale = spans_decades(series) ? Scale::logarithmic : Scale::linear;
    return figure_html(series, settings,
                       "Left is faster, low is nearer to the same cloth computed with a time step "
                       "of 1/240 s. Nothing is gained by a solver that has another one both on "
                       "its left and below it.");
}

}  // namespace

std::string plots_html(const json& report) {
    return speed_error_html(report) +
           per_frame_html(report, "/series/rmse_mm", "Error to the reference, frame by frame",
                          "error (mm)",
                          "Root of the mean squared distance of the vertices to the reference "
                          "of the same time step, each solver going on from its own states.") +
           per_frame_html(report, "/series/fine_rmse_mm",
                          "Error to the fine reference, frame by frame", "error (mm)",
                          "The same to the reference in steps of 1/240 s.") +
           per_frame_html(report, "/one_step/gap_per_frame",
                          "Energy gap of single steps, frame by frame", "gap",
                          "Each step starts in the reference's state: 0 is converged, 1 no better "
                          "than the extrapolation that all start from.") +
           per_frame_html(report, "/series/ms", "Time per frame", "time (ms)",
                          "Wall-clock time of each step of the rollout.") +
           per_frame_html(report, "/series/penetration_mm", "Deepest vertex inside the body",
                          "depth (mm)", "Deepest vertex of the garment below the body's skin.") +
           per_frame_html(report, "/series/stretch_p99", "Stretch of the garment",
                          "edge length / rest length",
                          "The length, relative to its rest length, that 1 % of the edges exceed.",
                          /*y_from_zero=*/false);
}

}  // namespace cloth
