#include "demos/train_series/metrics_row.h"

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "data/core/errors.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> items;
    size_t from = 0;
    for (size_t at = text.find(separator); at != std::string::npos;
         at = text.find(separator, from)) {
        items.push_back(text.substr(from, at - from));
        from = at + 1;
    }
    items.push_back(text.substr(from));
    return items;
}

}  // namespace

nlohmann::ordered_json last_metrics_row(const std::string& path) {
    nlohmann::ordered_json row = nlohmann::ordered_json::object();
    if (!std::filesystem::exists(path)) return row;
    std::vector<std::string> lines = split(read_file(path), '\n');
    lines.pop_back();  // what follows the last newline is no line, or half of one
    if (lines.size() < 2) return row;
    const std::vector<std::string> columns = split(lines.front(), ',');
    const std::vector<std::string> cells = split(lines.back(), ',');
    const std::string place = "line " + std::to_string(lines.size());
    if (cells.size() != columns.size())
        throw LoadError(path, place, "has another number of cells than the heading",
                        "delete the training's folder and run it again");
    for (size_t c = 0; c < columns.size(); ++c) {
        if (cells[c].empty()) continue;
        char* end = nullptr;
        const double value = std::strtod(cells[c].c_str(), &end);
        if (*end != '\0')
            throw LoadError(path, place, "has '" + cells[c] + "' for " + columns[c],
                            "delete the training's folder and run it again");
        row[columns[c]] = value;
    }
    return row;
}

}  // namespace cloth
