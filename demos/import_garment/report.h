#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/import_garment/options.h"

namespace cloth {

/// A garment's name in messages and its files.
struct WrittenGarment {
    std::string file;       ///< NAME.obj
    std::string worn_file;  ///< empty: it is worn as it is at rest
};

/// All figures, with their units in the names of the fields.
nlohmann::ordered_json import_json(const ImportOptions& options, const GarmentImport& import,
                                   const std::vector<WrittenGarment>& written);

/// The same for people, and what to do next.
std::string import_text(const ImportOptions& options, const GarmentImport& import,
                        const std::vector<WrittenGarment>& written, const TriMesh& skin);

}  // namespace cloth
