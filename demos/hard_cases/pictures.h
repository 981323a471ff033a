#pragma once

#include <string>
#include <vector>

#include "demos/hard_cases/hard_scene.h"
#include "render/image.h"

namespace cloth {

/// One column of a picture: what a solver made of a case.
struct HardStrip {
    std::string caption;
    std::vector<Points> x;  ///< the garment at the frames drawn, as far as it got
};

/// A primitive obstacle's surface at the end of the step, or a mesh obstacle's, in the world.
TriMesh surface_of(const Obstacle& obstacle);

/// All solvers of a case: a column per solver, a row per frame, the same camera along a row.
/// @param frames  of the scene at which the strips have the garment
/// @param rows  those of the frames that are drawn
Image draw_hard_case(const HardScene& scene, const std::vector<int>& frames,
                     const std::vector<int>& rows, const std::vector<HardStrip>& strips);

/// The same as a film of all frames, one row high, as fast as the scene.
/// @throws LoadError if the file cannot be written
void film_hard_case(const std::string& path, const HardScene& scene, const std::vector<int>& frames,
                    const std::vector<HardStrip>& strips);

}  // namespace cloth
