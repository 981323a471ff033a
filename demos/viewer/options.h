#pragma once

#include <string>
#include <vector>

#include "demos/bake/scene_options.h"

namespace cloth {

struct ViewerOptions {
    SceneOptions scene;
    int threads = 0;                 ///< 0: all cores
    int width = 1280, height = 800;  ///< of the window (pixels)
    int frames = 0;                  ///< steps after which the program ends; 0: it does not
    std::string screenshot;          ///< PNG file of the last picture; empty: none
    bool paused = false;             ///< it starts so
    std::string colours =
        "garments";     ///< what the cloth's colours show: garments, stretch, contact
    double wind = 0.0;  ///< speed (m/s)
    bool wireframe = false;
};

/// @throws UsageError naming the option; HelpText if it is asked for
ViewerOptions parse_viewer_options(const std::vector<std::string>& arguments);

}  // namespace cloth
