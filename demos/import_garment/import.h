#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/import_garment/options.h"

namespace cloth {

/// What was written.
struct ImportResult {
    std::vector<std::string> files;  ///< NAME.obj of each garment, outermost last
    std::string text;                ///< the report, as NAME.import.txt has it
    nlohmann::ordered_json json;     ///< the same in numbers
};

/// Reads the file, makes its garments, and writes them with report and picture into the folder.
/// @throws LoadError, ArgumentError, UsageError if the files or options cannot be used; then
/// nothing
///         has been written
ImportResult import_file(const ImportOptions& options);

}  // namespace cloth
