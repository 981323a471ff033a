#pragma once

#include <string>

#include "data/core/garment.h"

namespace cloth {

/// A garment of a coarse mesh that stands for a fine one: its fabric, its pins and what is painted
/// on it, at the places of the coarse vertices.
///
/// A coarse vertex is pinned if most of its place in the fine mesh belongs to pins. Limits of goals
/// are interpolated; where most of a place is without limit, so is the vertex.
///
///     const Garment coarse = carry_over(shirt, load_garment_mesh("tshirt_1000"), "coarse shirt");
///
/// @param mesh  at rest in the same place as the fine mesh (m)
/// @param name  of the result
/// @throws ArgumentError if the mesh is unusable or elsewhere (see MeshEmbedding), or has no pinned
///         vertex within one and a half edges of a pin of the fine garment
Garment carry_over(const Garment& fine, TriMesh mesh, std::string name);

/// Limits of skinned goals at other places: interpolated at the nearest points of the mesh that
/// they are painted on, as carry_over() does. Faces without area do not count.
/// @param x       N x 3 (m)
/// @param limits  of the mesh's vertices
/// @return  of N vertices; arrays that `limits` does not have are empty
/// @throws ArgumentError if the limits are of another mesh, or no face has an area
GoalLimits limits_at(const Points& x, const TriMesh& mesh, const GoalLimits& limits);

}  // namespace cloth
