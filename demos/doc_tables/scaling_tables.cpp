#include "demos/doc_tables/scaling_tables.h"

namespace cloth {

namespace {

/// A figure of each solver in one cell.
std::string side_by_side(const std::vector<DataRow>& rows, const std::string& member) {
    std::string cell;
    for (const DataRow& row : rows)
        cell += (cell.empty() ? "" : " / ") + significant(row.number(member), 2);
    return cell;
}

}  // namespace

MarkdownTable scaling_table(const std::vector<DataFile>& files) {
    const std::vector<DataRow> rows = files.at(0).rows("rows");
    std::vector<std::vector<DataRow>> sizes;  // the rows of one scene and size follow each other
    for (const DataRow& row : rows) {
        const bool goes_on = !sizes.empty() &&
                             sizes.back()[0].text("/scene") == row.text("/scene") &&
                             sizes.back()[0].number("/vertices") == row.number("/vertices");
        if (!goes_on) sizes.emplace_back();
        sizes.back().push_back(row);
    }
    MarkdownTable table;
    table.heading = {"scene", "vertices"};
    std::string order;
    for (const DataRow& row : sizes.at(0)) {
        table.heading.push_back(row.text("/solver") + ": ms per step, median / 95 %");
        order += (order.empty() ? "" : " / ") + row.text("/solver");
    }
    for (const char* figure : {"us per vertex", "set-up (ms)", "memory (MB)"})
        table.heading.push_back(std::string(figure) + ": " + order);
    for (const std::vector<DataRow>& size : sizes) {
        std::vector<std::string> cells = {size[0].text("/scene"),
                                          decimals(size[0].number("/vertices"), 0)};
        for (const DataRow& row : size)
            cells.push_back(significant(row.number("/ms_median"), 2) + " / " +
                            significant(row.number("/ms_p95"), 2) +
                            (row.is_null("/failure") ? "" : " (fails)"));
        for (const char* member : {"/us_per_vertex", "/setup_ms", "/memory_mb"})
            cells.push_back(side_by_side(size, member));
        table.rows.push_back(cells);
    }
    return table;
}

MarkdownTable many_characters_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"solver",
                     "garments are stepped",
                     "characters",
                     "ms per world step, median / 95 %",
                     "characters in a frame of 1/30 s",
                     "MB per character",
                     "MB of one more"};
    for (const DataRow& row : files.at(0).rows("rows"))
        table.rows.push_back(
            {row.text("/solver"), row.text("/stepping"), decimals(row.number("/characters"), 0),
             significant(row.number("/ms_median"), 2) + " / " +
                 significant(row.number("/ms_p95"), 2),
             decimals(row.number("/characters_per_frame"), 1),
             decimals(row.number("/memory_mb"), 1), decimals(row.number("/another_mb"), 1)});
    return table;
}

}  // namespace cloth
