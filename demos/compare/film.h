#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/compare/body_scene.h"
#include "demos/compare/references.h"
#include "demos/compare/trajectory.h"

namespace cloth {

/// One panel of the video: a solver's garment on the body.
struct FilmPanel {
    std::string name;
    const nlohmann::json* measurement;  ///< the solver's entry of the report, with its series
    const Trajectory* trajectory;
};

/// Draws all panels side by side, each with its solver's name, milliseconds per frame and current
/// error, into `out`/comparison.mp4 and some key frames `out`/key_frame_N.png.
/// @return the paths of the key frames
std::vector<std::string> make_film(const BodyScene& scene, const std::vector<FilmPanel>& panels,
                                   const std::string& out, const ProgressFunction& progress);

}  // namespace cloth
