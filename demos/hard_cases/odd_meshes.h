#pragma once

#include "data/core/mesh.h"

/// Level meshes (y = 0, normal +y) that are badly made, as those of users may be.
namespace cloth {

/// A ring of regular triangles from 1 mm at its inner to 5 cm at its outer border (radius 0.2 m).
TriMesh mixed_triangles();

/// A sheet of 0.6 m with pairs of columns 1 mm apart: needles with an angle of 1 degree between
/// triangles of 5 cm.
TriMesh needle_sheet();

/// A disc (radius 0.3 m) with a vertex of degree 20, vertices of degree 12, and one of degree 3 in
/// the middle of each of those triangles.
TriMesh uneven_degrees();

}  // namespace cloth
