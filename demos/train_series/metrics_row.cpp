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

/// The complete lines of a table.
std::vector<std::string> lines_of(const std::string& path) {
    std::vector<std::string> lines = split(read_file(path), '\n');
    lines.pop_back();  // what follows the last newline is no line, or half of one
    return lines;
}

/// Line `index` as numbers by column; the first line has their names.
nlohmann::ordered_json numbers_of(const std::string& path, const std::vector<std::string>& lines,
                                  size_t index) {
    const std::vector<std::string> columns = split(lines.front(), ',');
    const std::vector<std::string> cells = split(lines[index], ',');
    const std::string place = "line " + std::to_string(index + 1);
    const char* const remedy = "delete the training's folder and run it again";
    if (cells.size() != columns.size())
        throw LoadError(path, place, "has another number of cells than the heading", remedy);
    nlohmann::ordered_json row = nlohmann::ordered_json::object();
    for (size_t c = 0; c < columns.size(); ++c) {
        if (cells[c].empty()) continue;
        char* end = nullptr;
        const double value = std::strtod(cells[c].c_str(), &end);
        if (*end != '\0')
            throw LoadError(path, place, "has '" + cells[c] + "' for " + columns[c], remedy);
        row[columns[c]] = value;
    }
    return row;
}

}  // namespace

std::vector<nlohmann::ordered_json> metrics_rows(const std::string& path) {
    std::vector<nlohmann::ordered_json> rows;
    const std::vector<std::string> lines = lines_of(path);
    for (size_t k = 1; k < lines.size(); ++k) rows.push_back(numbers_of(path, lines, k));
    return rows;
}

nlohmann::ordered_json last_metrics_row(const std::string& path) {
    if (!std::filesystem::exists(path)) return nlohmann::ordered_json::object();
    const std::vector<std::string> lines = lines_of(path);
    if (lines.size() < 2) return nlohmann::ordered_json::object();
    return numbers_of(path, lines, lines.size() - 1);
}

}  // namespace cloth
