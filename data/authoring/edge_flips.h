#pragma once

#include "data/core/mesh.h"

namespace cloth {

/// Flips edges where that raises the smallest angle of the two triangles at them (Lawson 1977), as
/// long as the surface does not fold. One pass; every triangle takes part in one flip at most.
/// @return number of flips
int flip_edges(TriMesh& mesh);

}  // namespace cloth
