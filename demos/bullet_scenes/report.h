#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "demos/bullet_scenes/scene_run.h"

namespace cloth {

/// A row as JSON; numbers without meaning are null.
nlohmann::ordered_json scene_row_json(const SceneRow& row);

/// A row as a line of text, under scene_row_heading().
std::string scene_row_text(const SceneRow& row);
std::string scene_row_heading();

/// Writes {"provenance", "rows"}. @throws LoadError naming the file
void write_scene_report(const std::string& path, const std::vector<SceneRow>& rows);

}  // namespace cloth
