#include "demos/compare/report_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "render/plot.h"

namespace cloth {

namespace {

std::string name_of(const nlohmann::json& solver) {
    return solver.is_object() ? solver.value("name", "?") : "?";
}

std::string heading_html(const std::vector<ReportColumn>& columns) {
    std::string html = "<tr><th>solver</th>";
    for (const ReportColumn& column : columns) {
        html += "<th title=\"" + escaped(column.explanation) + "\">" + escaped(column.heading);
        if (!column.unit.empty()) html += "<br><small>" + escaped(column.unit) + "</small>";
        html += "</th>";
    }
    return html + "</tr>\n";
}

/// The lowest value of those who compete; NaN if fewer than two do or the column has no best.
double best_of(const nlohmann::json& solvers, const ReportColumn& column) {
    double best = std::numeric_limits<double>::infinity();
    int competitors = 0;
    for (const auto& solver : solvers) {
        const double value = number_at(solver, column.path);
        if (!competes(solver) || std::isnan(value)) continue;
        best = std::min(best, value);
        ++competitors;
    }
    return column.lowest_is_best && competitors >= 2 ? best
                                                     : std::numeric_limits<double>::quiet_NaN();
}

/// The frame in which a solver failed, beside its name.
std::string failure_html(const nlohmann::json& solver) {
    const double frame = number_at(solver, "/first_failed_frame");
    if (std::isnan(frame)) return "";
    return " <small class=\"failed\">fails in frame " + fixed_text(frame, 0) + "</small>";
}

std::string explanations_html(const std::vector<ReportColumn>& columns) {
    std::string html = "<dl>";
    for (const ReportColumn& column : columns)
        html += "<dt>" + escaped(column.heading) + "</dt><dd>" + escaped(column.explanation) +
                "</dd>\n";
    return html + "</dl>\n";
}

}  // namespace

double number_at(const nlohmann::json& solver, const std::string& path) {
    const nlohmann::json::json_pointer pointer(path);
    const bool there = solver.contains(pointer) && solver.at(pointer).is_number();
    return there ? solver.at(pointer).get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string short_number(double value) {
    if (std::isnan(value)) return "&ndash;";
    const double size = std::abs(value);
    if (size != 0.0 && (size < 1e-3 || size >= 1e6)) {
        const int exponent = static_cast<int>(std::floor(std::log10(size)));
        return fixed_text(value / std::pow(10.0, exponent), 1) + "&middot;10<sup>" +
               std::to_string(exponent) + "</sup>";
    }
    const int digits = size >= 99.95 || size == 0.0 ? 0
                       : size >= 9.995              ? 1
                       : size >= 0.9995             ? 2
                                                    : 3;
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::fixed, digits);
    return {text.data(), end.ptr};
}

bool competes(const nlohmann::json& solver) {
    if (!solver.is_object() || name_of(solver) == "reference") return false;
    return !solver.contains("first_failed_frame") || solver.at("first_failed_frame").is_null();
}

std::string table_html(const nlohmann::json& solvers, const std::vector<ReportColumn>& columns) {
    std::string html = "<div class=\"wide\"><table>\n" + heading_html(columns);
    std::vector<double> best;
    for (const ReportColumn& column : columns) best.push_back(best_of(solvers, column));
    int row = 0;
    for (const auto& solver : solvers) {
        html += "<tr><th><i style=\"background:" + category_colour(row++) + "\"></i>" +
                escaped(name_of(solver)) + failure_html(solver) + "</th>";
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const double value = number_at(solver, columns[c].path);
            const bool is_best = competes(solver) && value == best[c];
            html += is_best ? "<td class=\"best\">" : "<td>";
            html += short_number(columns[c].factor * value) + "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</table></div>\n" + explanations_html(columns);
}

}  // namespace cloth
