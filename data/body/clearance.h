#pragma once

#include "data/core/surface_distance.h"

namespace cloth {

/// Moves vertices outwards until no vertex, edge midpoint or face centre of `mesh` is nearer to the
/// body than `clearance` (m); the vertices around take part, so that no dents or spikes appear.
/// @return the smallest signed distance that is left (m); below `clearance` if it cannot be reached
double push_out(TriMesh& mesh, const SurfaceDistance& body, double clearance);

/// Moves vertices outwards until the mesh lies over a garment that is worn below it: wherever the
/// two are nearer to each other than `reach` (m), its vertices, edge midpoints and face centres are
/// `gap` (m) above the other's surface. Beside its borders the gap falls to 0 within `reach`.
/// @param inner  a surface with borders whose faces look outwards
/// @return whether it has been reached
bool push_over(TriMesh& mesh, const SurfaceDistance& inner, double gap, double reach);

}  // namespace cloth
