#pragma once

#include <memory>
#include <string>
#include <vector>

#include "demos/compare/comparison_scene.h"

namespace cloth {

struct SizedSceneSettings {
    std::string name = "sphere";  ///< of scaling_scenes()
    int vertices = 4000;          ///< of the garment, 500 to 60000; met within 3 %
    int frames = 15;
    std::string work;  ///< folder that keeps garments, made if it is not there
};

std::vector<std::string> scaling_scenes();

/// A scene whose garment has so many vertices: a sheet, or what the recipe of that name makes for
/// the default body.
/// @throws UsageError for an unknown scene, ArgumentError if so many vertices cannot be had
std::unique_ptr<ComparisonScene> make_sized_scene(const SizedSceneSettings& settings);

}  // namespace cloth
