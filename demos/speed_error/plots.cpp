#include "demos/speed_error/plots.h"

#include <algorithm>
#include <array>

#include "demos/speed_error/solver_family.h"
#include "render/plot.h"

namespace cloth {
namespace {

using Kind = SolverFamily::Kind;

/// The settings of one family, in the order of the rows.
struct Family {
    SolverFamily family;
    std::vector<const SolverRow*> rows;
};

std::vector<Family> families_of(const std::vector<SolverRow>& rows) {
    std::vector<Family> families;
    for (const SolverRow& row : rows) {
        const SolverFamily family = solver_family(row.solver);
        auto same = std::find_if(families.begin(), families.end(), [&](const Family& other) {
            return other.family.name == family.name;
        });
        if (same == families.end()) same = families.insert(same, {family, {}});
        same->rows.push_back(&row);
    }
    return families;
}

/// The colour of the k-th family of its kind.
std::string colour_of(Kind kind, size_t k) {
    static const std::array<const char*, 3> bullet = {"#f2a07b", "#d55e00", "#8a3b00"};
    static const std::array<const char*, 8> network = {"#cc3399", "#e69f00", "#7a5cc9", "#a89f00",
                                                       "#56b4e9", "#b0413e", "#4f8f9f", "#8c6d46"};
    switch (kind) {
        case Kind::bullet:
            return bullet[k % bullet.size()];
        case Kind::xpbd:
            return "#009e73";
        case Kind::quasi_newton:
            return "#0072b2";
        case Kind::newton:
            return "#000000";
        case Kind::skinning:
            return "#6b6b6b";
        case Kind::network:
            break;
    }
    return network[k % network.size()];
}

/// What a family is called before ", LibTorch", ", bfloat16" or ", BDF2".
std::string plain_name(const std::string& name) {
    return name.substr(0, name.find(", "));
}

/// What it is called after that, such as "BDF2 "; Bullet's time steps are no variety.
std::string variety(const SolverFamily& family) {
    const size_t comma = family.name.find(", ");
    if (comma == std::string::npos || family.kind == Kind::bullet) return "";
    return family.name.substr(comma + 2) + " ";
}

/// One colour per family; its varieties have the same one, and dashes.
std::vector<std::string> colours_of(const std::vector<Family>& families) {
    std::array<std::vector<std::string>, 6> seen;  // names of each kind so far
    std::vector<std::string> colours;
    for (const Family& family : families) {
        const bool bullet = family.family.kind == Kind::bullet;
        const std::string name = bullet ? family.family.name : plain_name(family.family.name);
        std::vector<std::string>& names = seen[static_cast<size_t>(family.family.kind)];
        const auto at = std::find(names.begin(), names.end(), name);
        colours.push_back(colour_of(family.family.kind, static_cast<size_t>(at - names.begin())));
        if (at == names.end()) names.push_back(name);
    }
    return colours;
}

struct Measure {
    std::string name, title, label;
    double SolverRow::*value;
};

/// A family's line through all settings, then its points: discs, and crosses for failed rollouts.
void add_series(const Family& family, const Measure& measure, const std::string& colour,
                std::vector<Series>& series) {
    Series line, discs, crosses;
    line.name = family.family.name + ": " + family.family.counts;
    line.colour = discs.colour = crosses.colour = colour;
    line.dashed = !variety(family.family).empty();
    discs.style = crosses.style = SeriesStyle::points;
    crosses.marker = Marker::cross;
    for (const SolverRow* row : family.rows) {
        const double x = row->ms_median, y = row->*measure.value;
        Series& points = row->first_failed_frame ? crosses : discs;
        line.x.push_back(x);
        line.y.push_back(y);
        points.x.push_back(x);
        points.y.push_back(y);
        points.texts.push_back(variety(family.family) + solver_family(row->solver).setting);
    }
    series.insert(series.end(), {line, discs, crosses});
}

Series failed_legend() {
    Series legend;
    legend.name = "rollout failed";
    legend.style = SeriesStyle::points;
    legend.marker = Marker::cross;
    legend.colour = "#333";
    return legend;
}

std::string plot(const std::vector<SolverRow>& rows, const Measure& measure) {
    std::vector<Series> series;
    const std::vector<Family> families = families_of(rows);
    const std::vector<std::string> colours = colours_of(families);
    for (size_t k = 0; k < families.size(); ++k)
        add_series(families[k], measure, colours[k], series);
    series.push_back(failed_legend());
    PlotSettings settings;
    settings.title = rows.front().scene + ", " + rows.front().fabric + " cotton: " + measure.title;
    settings.x_label = "time per frame (ms, median), " + std::to_string(rows.front().threads) +
                       (rows.front().threads == 1 ? " thread" : " threads");
    settings.y_label = measure.label;
    settings.x_scale = settings.y_scale = Scale::logarithmic;
    settings.width = 960;
    settings.height = 520;
    return plot_svg(series, settings);
}

}  // namespace

std::vector<NamedPlot> speed_error_plots(const std::vector<SolverRow>& rows) {
    const std::array<Measure, 4> measures = {
        {{"gap", "time against energy gap of one step", "energy gap (1: the common guess; median)",
          &SolverRow::gap_median},
         {"progress", "time against what one step leaves to do",
          "progress (0: converged, 1: not moved; median)", &SolverRow::progress_median},
         {"rmse", "time against error to the reference of 1/30 s", "RMSE of the rollout (mm)",
          &SolverRow::rollout_rmse_mm},
         {"fine_rmse", "time against error to the reference of 1/240 s", "RMSE of the rollout (mm)",
          &SolverRow::fine_rmse_mm}}};
    std::vector<NamedPlot> plots;
    if (rows.empty()) return plots;
    for (const Measure& measure : measures) plots.push_back({measure.name, plot(rows, measure)});
    return plots;
}

}  // namespace cloth
