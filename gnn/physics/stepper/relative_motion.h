#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"

namespace cloth {

/// How far (m) pins, and surfaces that may touch the garment, move at most during the step,
/// relative to the garment's mean motion. Meshes: their vertices and faces in the box that garment
/// and motion span; a face moves as far as the farthest of its corners. Goals: how far their limits
/// pull.
///
/// A garment that swings is not where its mean is: primitives count for no more than the vertices
/// that may come near move over them, pins for no more than they move over the vertices next to
/// them.
double relative_motion(const Garment& garment, const Boundary& boundary, double dt,
                       const ClothState& state);

}  // namespace cloth
