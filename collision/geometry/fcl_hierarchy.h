#pragma once

#include <vector>

#include "collision/geometry/binary_node.h"
#include "data/core/types.h"

namespace cloth {

/// The hierarchy that FCL builds over a mesh (BVHModel of axis-aligned boxes), topology only; the
/// root comes first. Empty if the mesh has no faces. Coordinates that are not finite count as 0.
std::vector<BinaryNode> build_fcl_hierarchy(const Points& vertices, const Faces& faces);

}  // namespace cloth
