#pragma once

#include <string>
#include <vector>

#include "demos/hard_cases/hard_scene.h"
#include "render/image.h"

namespace cloth {

/// One column of a picture: what a solver made of a case.
struct HardStrip {
    std::string caption;
    std::vector<Points> x;  ///< the garment at the picture's frames, as far as it got
};

/// A primitive obstacle's surface at the end of the step, or a mesh obstacle's, in the world.
TriMesh surface_of(const Obstacle& obstacle);

/// All solvers of a case: a column per solver, a row per frame, the same camera along a row.
/// @param frames  of the scene that are drawn (see picture_frames())
Image draw_hard_case(const HardScene& scene, const std::vector<int>& frames,
                     const std::vector<HardStrip>& strips);

}  // namespace cloth
