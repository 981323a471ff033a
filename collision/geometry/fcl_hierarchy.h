#pragma once

#include <vector>

#include "data/core/types.h"

namespace cloth {

/// A node of a binary hierarchy over the faces of a mesh: two children, or one face.
struct BinaryNode {
    int left = -1, right = -1;  ///< children, larger than the node's own index; -1 in a leaf
    int face = -1;              ///< leaf: its face
    int face_count = 0;         ///< faces below this node
};

/// The hierarchy that FCL builds over a mesh (BVHModel of axis-aligned boxes), topology only; the
/// root comes first. Empty if the mesh has no faces. Coordinates that are not finite count as 0.
std::vector<BinaryNode> build_fcl_hierarchy(const Points& vertices, const Faces& faces);

}  // namespace cloth
