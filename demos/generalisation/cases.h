#pragma once

#include <string>
#include <vector>

#include "demos/speed_error/scenes.h"

namespace cloth {

/// Scenes that have one thing in common: what of them networks were trained on.
struct CaseGroup {
    std::string name;
    std::vector<SceneSettings> scenes;
};

/// "trained": garments, motions and body that networks are trained on; "motion", "body", "garment":
/// one of the three is new to them; "all": everything is.
std::vector<CaseGroup> generalisation_cases(int frames);

}  // namespace cloth
