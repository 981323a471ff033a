#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"

namespace cloth {

/// How far (m) pins, and surfaces that may touch the garment, move at most during the step,
/// relative to the garment's mean motion. Meshes: their vertices and faces in the box that garment
/// and motion span; a face moves as far as the farthest of its corners. Goals: how far their limits
/// pull.
double relative_motion(const Garment& garment, const Boundary& boundary, double dt,
                       const ClothState& state);

}  // namespace cloth
