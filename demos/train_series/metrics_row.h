#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cloth {

/// The last row of a training's metrics.csv as numbers by column; cells that are empty are left
/// out. Empty if the file has no complete row.
/// @throws LoadError naming file and line if a cell is not a number
nlohmann::ordered_json last_metrics_row(const std::string& path);

/// All complete rows, in the same way. @throws LoadError if there is no such file, or as above
std::vector<nlohmann::ordered_json> metrics_rows(const std::string& path);

}  // namespace cloth
