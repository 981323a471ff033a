#include "demos/paper_tables/figures.h"

#include <array>
#include <limits>
#include <map>

#include "render/plot.h"

namespace cloth {

using nlohmann::ordered_json;

namespace {

constexpr std::array<const char*, 6> term_names = {"strain",  "bending", "contact",
                                                   "gravity", "inertia", "friction"};

double number(const ordered_json& value) {
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

const ordered_json* detailed_row(const ordered_json& report, const std::string& solver) {
    for (const ordered_json& row : report.at("rows"))
        if (row.value("solver", "") == solver && row.contains("terms")) return &row;
    return nullptr;
}

}  // namespace

std::string figure_6_csv(const ordered_json& report) {
    std::string table = "garment,solver,frame";
    for (const char* term : term_names) table += std::string(",") + term;
    table += "\n";
    for (const ordered_json& row : report.at("rows")) {
        if (!row.contains("terms")) continue;
        int frame = 0;
        for (const ordered_json& one : row.at("terms")) {
            table += row.at("garment").get<std::string>() + "," +
                     row.at("solver").get<std::string>() + "," + std::to_string(++frame);
            for (const char* term : term_names)
                table += "," + (one.at(term).is_null() ? "" : one.at(term).dump());
            table += "\n";
        }
    }
    return table;
}

std::string figure_6_svg(const ordered_json& report, const std::string& solver,
                         const std::string& other) {
    std::vector<Series> series;
    for (const std::string& name : {solver, other}) {
        const ordered_json* row = detailed_row(report, name);
        if (!row) continue;
        for (size_t k = 0; k < term_names.size(); ++k) {
            Series line;
            line.name = name + ": " + term_names[k];
            line.colour = category_colour(static_cast<int>(k));
            line.dashed = name == other;
            for (const ordered_json& one : row->at("terms")) {
                line.x.push_back(static_cast<double>(line.x.size() + 1) / 30.0);
                line.y.push_back(number(one.at(term_names[k])));
            }
            series.push_back(line);
        }
    }
    PlotSettings settings;
    settings.title = "loss by term, networks alone, T-shirt";
    settings.x_label = "time (s)";
    settings.y_label = "energy of a step (J)";
    settings.y_scale = Scale::logarithmic;
    return plot_svg(series, settings);
}

std::string figure_7_svg(const ordered_json& report) {
    static const std::array<std::pair<const char*, const char*>, 3> gaps = {
        {{"gap_tshirt_median", "T-shirt, new motion"},
         {"gap_sheet_median", "sheets"},
         {"gap_training_median", "scenes trained on"}}};
    std::vector<Series> series;
    for (const auto& [column, name] : gaps) {
        std::map<int, std::pair<double, int>> sums;  // of a number of neighbours; how many
        for (const ordered_json& row : report.value("neighbours", ordered_json::array())) {
            auto& [sum, count] = sums[std::stoi(row.at("name").get<std::string>())];
            sum += number(row.value(column, ordered_json()));
            ++count;
        }
        Series line;
        line.name = name;
        line.style = SeriesStyle::line_and_points;
        for (const auto& [neighbours, sum] : sums) {
            line.x.push_back(neighbours);
            line.y.push_back(sum.first / sum.second);
        }
        series.push_back(line);
    }
    PlotSettings settings;
    settings.title = "gap after equally many iterations";
    settings.x_label = "sampled neighbours";
    settings.y_label = "gap of a step";
    return plot_svg(series, settings);
}

}  // namespace cloth
