#pragma once

#include <vector>

#include "collision/geometry/binary_node.h"

namespace cloth {

// FCL's functions take the Eigen that all others have, and ours is another one (data/core/types.h).
// So what calls FCL is compiled without our definitions and gets plain arrays.

/// The hierarchy that FCL builds over a mesh; empty if FCL refuses the mesh.
/// @param vertices  (vertex_count x 3), finite
/// @param faces     (face_count x 3)
std::vector<BinaryNode> fcl_model_nodes(const double* vertices, int vertex_count, const int* faces,
                                        int face_count);

}  // namespace cloth
