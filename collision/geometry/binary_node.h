#pragma once

namespace cloth {

/// A node of a binary hierarchy over the faces of a mesh: two children, or one face.
struct BinaryNode {
    int left = -1, right = -1;  ///< children, larger than the node's own index; -1 in a leaf
    int face = -1;              ///< leaf: its face
    int face_count = 0;         ///< faces below this node
};

}  // namespace cloth
