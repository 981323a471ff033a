#pragma once

#include <memory>
#include <string>
#include <vector>

#include "demos/compare/comparison_scene.h"

namespace cloth {

struct SceneSettings {
    std::string name = "tshirt";   ///< sheet, sphere or a garment, of garment_names(), on a body
    std::string fabric = "soft";   ///< soft, real
    int frames = 30;               ///< all with references; 0: as long as the scene lasts
    int vertices = 4000;           ///< of the sheets
    int rate = 30;                 ///< frames per second
    std::string body = "default";  ///< that wears the garment, see body_named()
    std::string motion = "01_01";  ///< of the body
    bool limbs = false;            ///< of the body are told apart, see LimbOverlap
};

/// Where the garment of the scene on a body is not another one.
std::vector<std::string> scene_names();

/// What happens in a scene, in a sentence.
std::string scene_description(const std::string& name);

/// @throws UsageError naming the choices if there is no such scene, garment or fabric
std::unique_ptr<ComparisonScene> make_scene(const SceneSettings& settings);

}  // namespace cloth
