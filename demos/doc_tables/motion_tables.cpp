#include "demos/doc_tables/motion_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "demos/compare/statistics.h"
#include "demos/doc_tables/solver_cells.h"

namespace cloth {

namespace {

/// The different texts of a member, in the order in which they come first.
std::vector<std::string> names_of(const std::vector<DataRow>& rows, const std::string& member) {
    std::vector<std::string> names;
    for (const DataRow& row : rows)
        if (std::find(names.begin(), names.end(), row.text(member)) == names.end())
            names.push_back(row.text(member));
    return names;
}

std::vector<DataRow> rows_of(const DataFile& file, const std::string& stepper) {
    std::vector<DataRow> rows;
    for (const DataRow& row : file.rows("rows"))
        if (row.text("/stepper") == stepper) rows.push_back(row);
    return rows;
}

/// The highest number of the rows that have one; NaN if none has.
double highest(const std::vector<DataRow>& rows, const std::string& member) {
    double value = std::nan("");
    for (const DataRow& row : rows) value = std::fmax(value, row.number(member));
    return value;
}

std::string count_of(const std::vector<DataRow>& rows,
                     const std::function<bool(const DataRow&)>& counts) {
    return std::to_string(std::count_if(rows.begin(), rows.end(), counts));
}

/// Clips in which a stepper stretches the shirt more than 1.1 times as far as the reference does.
std::string overstretched(const DataFile& file, const std::vector<DataRow>& rows) {
    return count_of(rows, [&](const DataRow& row) {
        const DataRow reference =
            file.row("rows", {{"case", row.text("/case")}, {"stepper", "reference"}});
        return row.number("/stretch_p99") > 1.1 * reference.number("/stretch_p99");
    });
}

}  // namespace

MarkdownTable hard_cases_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver", "cases held", "of", "deepest vertex inside (mm)"};
    for (const std::string& stepper : names_of(files.at(0).rows("rows"), "/stepper")) {
        const std::vector<DataRow> rows = rows_of(files.at(0), stepper);
        table.rows.push_back(
            {stepper, count_of(rows, [](const DataRow& row) { return row.truth("/held"); }),
             count_of(rows, [](const DataRow& row) { return !row.is_null("/held"); }),
             decimals(highest(rows, "/penetration_max_mm"), 2)});
    }
    return table;
}

MarkdownTable starts_table(const std::vector<DataFile>& files) {
    const DataFile& file = files.at(0);
    MarkdownTable table;
    table.heading = {"solver"};
    const std::vector<std::string> cases = names_of(file.rows("rows"), "/case");
    for (const std::string& name : cases) table.heading.push_back(name);
    for (const std::string& stepper : names_of(file.rows("rows"), "/stepper")) {
        table.rows.push_back({stepper});
        for (const std::string& name : cases) {
            const DataRow row = file.row("rows", {{"case", name}, {"stepper", stepper}});
            table.rows.back().push_back(decimals(row.number("/starts_held"), 0) + " of " +
                                        decimals(row.number("/starts"), 0));
        }
    }
    return table;
}

MarkdownTable motions_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"body",
                     "solver",
                     "clips",
                     "frames",
                     "shirts lost",
                     "deepest vertex inside (mm)",
                     "clips stretched to 1.2 or less",
                     "most stretch",
                     "clips stretched more than 1.1 times the reference's"};
    const char* const bodies[] = {"with limbs", "one surface"};
    for (size_t body = 0; body < 2; ++body) {
        const DataFile& file = files.at(body);
        for (const std::string& stepper : names_of(file.rows("rows"), "/stepper")) {
            const std::vector<DataRow> rows = rows_of(file, stepper);
            double frames = 0.0;
            for (const DataRow& row : rows) frames += row.number("/frames");
            table.rows.push_back(
                {bodies[body], stepper, std::to_string(rows.size()), decimals(frames, 0),
                 count_of(rows, [](const DataRow& row) { return !row.truth("/finite"); }),
                 decimals(highest(rows, "/penetration_max_mm"), 2),
                 count_of(rows,
                          [](const DataRow& row) { return row.number("/stretch_p99") <= 1.2; }),
                 decimals(highest(rows, "/stretch_p99"), 2),
                 stepper == "reference" ? "–" : overstretched(file, rows)});
        }
    }
    return table;
}

MarkdownTable alone_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver"};
    for (const char* garment : garments_over_proxies) {
        table.heading.push_back(std::string(garment) + ": clips held");
        for (const char* figure :
             {"stretch in each clip's worst frame", "deepest vertex inside (mm)", "ms"})
            table.heading.push_back(figure);
    }
    for (const std::string& stepper : names_of(files.at(0).rows("rows"), "/stepper")) {
        table.rows.push_back({stepper});
        for (const DataFile& file : files) {
            std::string stretch;
            std::vector<double> ms;
            const std::vector<DataRow> rows = rows_of(file, stepper);
            for (const DataRow& row : rows) {
                stretch += (stretch.empty() ? "" : " / ") + decimals(row.number("/stretch_p99"), 2);
                ms.push_back(row.number("/ms_median"));
            }
            for (const std::string& cell :
                 {count_of(rows, [](const DataRow& row) { return row.truth("/held"); }) + " of " +
                      std::to_string(rows.size()),
                  stretch, decimals(highest(rows, "/penetration_max_mm"), 2),
                  significant(median(ms), 2)})
                table.rows.back().push_back(cell);
        }
    }
    return table;
}

MarkdownTable clip_times_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver",
                     "clips",
                     "clips in which the shirt stays on",
                     "ms per step: median of the clips",
                     "95 % of a clip's steps, over its median: middle clip / worst",
                     "longest step of a clip, over its median: middle clip / worst",
                     "clips with a step above 3 medians"};
    for (const std::string& stepper : names_of(files.at(0).rows("rows"), "/stepper")) {
        const std::vector<DataRow> rows = rows_of(files.at(0), stepper);
        std::vector<double> medians, p95, longest;
        for (const DataRow& row : rows) {
            medians.push_back(row.number("/ms_median"));
            p95.push_back(row.number("/ms_p95") / medians.back());
            longest.push_back(row.number("/ms_longest") / medians.back());
        }
        const auto middle_and_worst = [](const std::vector<double>& values) {
            return significant(median(values), 2) + " / " + significant(quantile(values, 1.0), 2);
        };
        table.rows.push_back(
            {stepper, std::to_string(rows.size()),
             count_of(rows, [](const DataRow& row) { return row.truth("/held"); }),
             significant(median(medians), 2), middle_and_worst(p95), middle_and_worst(longest),
             std::to_string(std::count_if(longest.begin(), longest.end(),
                                          [](double value) { return value > 3.0; }))});
    }
    return table;
}

namespace {

using CellText = std::function<std::string(double)>;

/// A figure of every solver in one cell, "–" where none has one.
std::string solver_cells(const DataFile& file, const std::vector<std::string>& solvers,
                         const std::string& scene, const std::string& member,
                         const CellText& text) {
    std::string cells, dashes;
    for (const std::string& solver : solvers) {
        const DataRow row = file.row("rows", {{"scene", scene}, {"solver", solver}});
        cells += (cells.empty() ? "" : " / ") + text(row.number(member));
        dashes += (dashes.empty() ? "" : " / ") + text(std::nan(""));
    }
    return cells == dashes ? text(std::nan("")) : cells;
}

struct SceneColumn {
    std::string heading, member;
    CellText text;
};

/// A row per scene; its cells have the figures of all solvers.
MarkdownTable scenes_table(const DataFile& file, const std::vector<SceneColumn>& columns) {
    const std::vector<DataRow> rows = file.rows("rows");
    const std::vector<std::string> solvers = names_of(rows, "/solver");
    std::string order;
    for (const std::string& solver : solvers) order += (order.empty() ? "" : " / ") + solver;
    MarkdownTable table;
    table.heading = {"scene: " + order};
    for (const SceneColumn& column : columns) table.heading.push_back(column.heading);
    for (const std::string& scene : names_of(rows, "/scene")) {
        table.rows.push_back({scene});
        for (const SceneColumn& column : columns)
            table.rows.back().push_back(
                solver_cells(file, solvers, scene, column.member, column.text));
    }
    return table;
}

CellText fixed(int digits) {
    return [digits](double value) { return decimals(value, digits); };
}

std::string two(double value) {
    return significant(value, 2);
}

}  // namespace

MarkdownTable bullet_scenes_table(const std::vector<DataFile>& files) {
    return scenes_table(files.at(0), {{"rest (mm)", "/rest_error_mm", fixed(0)},
                                      {"energy (mm)", "/rest_energy_mm", fixed(1)},
                                      {"momentum", "/momentum_error", fixed(3)},
                                      {"inside (mm)", "/penetration_max_mm", fixed(0)},
                                      {"ms per step, median", "/ms_median", two},
                                      {"in the last second", "/ms_median_last_second", two}});
}

MarkdownTable bullet_demos_table(const std::vector<DataFile>& files) {
    return scenes_table(files.at(0), {{"energy made (J)", "/energy_rise_j", two},
                                      {"stretch: 99 %", "/stretch_p99", fixed(2)},
                                      {"longest", "/stretch_max", fixed(2)},
                                      {"inside (mm)", "/penetration_max_mm", fixed(0)},
                                      {"fastest node (m/s)", "/node_speed_max", fixed(0)},
                                      {"ms per step, median", "/ms_median", two}});
}

}  // namespace cloth
