#include "demos/doc_tables/motion_tables.h"

#include <algorithm>
#include <cmath>
#include <functional>

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

namespace {

/// Cells that hold a figure of every solver, "–" where none has one.
class SolverCells {
 public:
    explicit SolverCells(const DataFile& file)
        : m_file(file), m_solvers(names_of(file.rows("rows"), "/solver")) {}

    /// "scene: SOLVER / SOLVER"
    std::string heading() const {
        std::string order;
        for (const std::string& solver : m_solvers) order += (order.empty() ? "" : " / ") + solver;
        return "scene: " + order;
    }
    std::vector<std::string> scenes() const { return names_of(m_file.rows("rows"), "/scene"); }

    template <class Text>
    std::string of(const std::string& scene, const std::string& member, const Text& text) const {
        std::string cells, dashes;
        for (const std::string& solver : m_solvers) {
            const DataRow row = m_file.row("rows", {{"scene", scene}, {"solver", solver}});
            cells += (cells.empty() ? "" : " / ") + text(row.number(member));
            dashes += (dashes.empty() ? "" : " / ") + text(std::nan(""));
        }
        return cells == dashes ? text(std::nan("")) : cells;
    }

 private:
    const DataFile& m_file;
    std::vector<std::string> m_solvers;
};

auto fixed(int digits) {
    return [digits](double value) { return decimals(value, digits); };
}

std::string two(double value) {
    return significant(value, 2);
}

}  // namespace

MarkdownTable bullet_scenes_table(const std::vector<DataFile>& files) {
    const SolverCells cells(files.at(0));
    MarkdownTable table;
    table.heading = {cells.heading(), "rest (mm)",   "energy (mm)",       "momentum",
                     "inside (mm)",   "ms per step", "in the last second"};
    for (const std::string& scene : cells.scenes())
        table.rows.push_back({scene, cells.of(scene, "/rest_error_mm", fixed(0)),
                              cells.of(scene, "/rest_energy_mm", fixed(1)),
                              cells.of(scene, "/momentum_error", fixed(3)),
                              cells.of(scene, "/penetration_max_mm", fixed(0)),
                              cells.of(scene, "/ms_median", two),
                              cells.of(scene, "/ms_median_last_second", two)});
    return table;
}

MarkdownTable bullet_demos_table(const std::vector<DataFile>& files) {
    const SolverCells cells(files.at(0));
    MarkdownTable table;
    table.heading = {cells.heading(), "energy made (J)",    "stretch: 99 %", "longest",
                     "inside (mm)",   "fastest node (m/s)", "ms per step"};
    for (const std::string& scene : cells.scenes())
        table.rows.push_back(
            {scene, cells.of(scene, "/energy_rise_j", two),
             cells.of(scene, "/stretch_p99", fixed(2)), cells.of(scene, "/stretch_max", fixed(2)),
             cells.of(scene, "/penetration_max_mm", fixed(0)),
             cells.of(scene, "/node_speed_max", fixed(0)), cells.of(scene, "/ms_median", two)});
    return table;
}

}  // namespace cloth
