#pragma once

#include "data/core/surface_distance.h"

namespace cloth {

/// Moves vertices outwards until no vertex, edge midpoint or face centre of `mesh` is nearer to the
/// body than `clearance` (m); the vertices around take part, so that no dents or spikes appear.
/// @return the smallest signed distance that is left (m); below `clearance` if it cannot be reached
double push_out(TriMesh& mesh, const SurfaceDistance& body, double clearance);

}  // namespace cloth
