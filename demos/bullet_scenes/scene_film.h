#pragma once

#include <string>
#include <vector>

#include "demos/bullet_scenes/scene_run.h"

namespace cloth {

/// Draws the runs of one scene side by side into `path` (MP4, as many pictures per second as were
/// recorded) and its first, middle and last picture into one PNG beside it.
void make_scene_film(const SceneRecipe& recipe, const std::vector<SceneResult>& runs,
                     int pictures_per_second, const std::string& path,
                     const SceneProgress& progress = {});

}  // namespace cloth
