#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// The part of a surface where `level` (|V|, linear on each triangle) is negative, cut along its
/// zero line.
TriMesh cut_surface(const TriMesh& mesh, const VectorX& level);

/// The connected part of a surface whose vertex is nearest to `p`, without loose vertices.
TriMesh keep_component(const TriMesh& mesh, const Vec3& p);

/// What remesh() does with edges at which a surface is folded over by more than 120 degrees, as
/// a collar is.
enum class Folds {
    smooth,  ///< it draws them inwards: for surfaces that have none but by chance
    keep     ///< they stay, at the price of some sharp angles beside them
};

/// Remeshes an open surface to `target_vertices` (within 1.5 %) triangles that are as equal as they
/// can be: split, collapse, flip and relax (Botsch and Kobbelt 2004, CGAL), then smoothing within
/// the surface until every angle is above 25 degrees, or as near as it gets.
/// Borders stay where they are, with new vertices.
/// @param kept  vertices of `surface` where the result has vertices, too, such as corners, the most
///              important ones first. Those that are nearer than 0.9 edges to an earlier one, or
///              for which there is no vertex left to take, are passed over
/// @throws ArgumentError if the surface is not manifold
TriMesh remesh(const TriMesh& surface, int target_vertices, const std::vector<int>& kept = {},
               Folds keep = Folds::smooth);

}  // namespace cloth
