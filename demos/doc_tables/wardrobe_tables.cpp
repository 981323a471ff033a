#include "demos/doc_tables/wardrobe_tables.h"

#include <algorithm>

namespace cloth {

namespace {

/// The values of a member, each once, in the order in which they come.
std::vector<std::string> distinct(const std::vector<DataRow>& rows, const std::string& member) {
    std::vector<std::string> values;
    for (const DataRow& row : rows)
        if (std::find(values.begin(), values.end(), row.text(member)) == values.end())
            values.push_back(row.text(member));
    return values;
}

/// How a figure compares with the same of another group.
std::string times(const DataRow& row, const DataRow& other, const std::string& member) {
    return " (" + significant(row.number(member) / other.number(member), 2) + ")";
}

std::string gap_cell(const DataRow& row, const DataRow& seen) {
    if (row.is_null("/gap")) return "–";
    const std::string cell = significant(row.number("/gap"), 2) + times(row, seen, "/relative_gap");
    if (row.number("/gap_scenes") == row.number("/scenes")) return cell;
    return cell + ", in " + decimals(row.number("/gap_scenes"), 0) + " of " +
           decimals(row.number("/scenes"), 0);
}

}  // namespace

MarkdownTable generalisation_table(const std::vector<DataFile>& files) {
    const std::vector<DataRow> rows = files.at(0).rows("rows");
    const std::vector<std::string> groups = distinct(rows, "/group");
    MarkdownTable table;
    table.heading = {"solver", "figure"};
    table.heading.insert(table.heading.end(), groups.begin(), groups.end());
    for (const std::string& solver : distinct(rows, "/solver")) {
        const DataRow seen = files.at(0).row("rows", {{"group", groups.at(0)}, {"solver", solver}});
        std::vector<std::string> gap = {solver, "gap"}, rollout = {solver, "rollout (mm)"};
        for (const std::string& group : groups) {
            const DataRow row = files.at(0).row("rows", {{"group", group}, {"solver", solver}});
            gap.push_back(gap_cell(row, seen));
            std::string cell =
                significant(row.number("/rollout_mm"), 2) + times(row, seen, "/relative_rollout");
            if (row.number("/failed") > 0)
                cell += ", " + decimals(row.number("/failed"), 0) + " of " +
                        decimals(row.number("/scenes"), 0) + " lost";
            rollout.push_back(cell);
        }
        if (!seen.is_null("/gap")) table.rows.push_back(gap);  // solvers of small steps have none
        table.rows.push_back(rollout);
    }
    return table;
}

MarkdownTable lookbook_table(const std::vector<DataFile>& files) {
    const std::vector<DataRow> rows = files.at(0).rows("rows");
    const std::vector<std::string> bodies = distinct(rows, "/body");
    MarkdownTable table;
    table.heading = {"garment", "vertices"};
    for (const std::string& body : bodies)
        table.heading.push_back(body + ": stretch of 99 % / of all, deepest (mm)");
    for (const std::string& garment : distinct(rows, "/garment")) {
        const DataRow first = files.at(0).row("rows", {{"garment", garment}});
        std::vector<std::string> cells = {garment, decimals(first.number("/vertices"), 0)};
        for (const std::string& body : bodies) {
            const DataRow row = files.at(0).row("rows", {{"garment", garment}, {"body", body}});
            cells.push_back(decimals(row.number("/stretch_p99"), 2) + " / " +
                            decimals(row.number("/stretch_max"), 2) + ", " +
                            decimals(row.number("/depth_mm"), 1) +
                            (row.is_null("/failure") ? "" : " (" + row.text("/failure") + ")"));
        }
        table.rows.push_back(cells);
    }
    return table;
}

}  // namespace cloth
