#pragma once

#include <string>

#include "data/core/mesh.h"

namespace cloth {

/// A surface as cloth needs it, and what had to be done to get it.
struct RepairedMesh {
    TriMesh mesh;
    int faces_without_area = 0;  ///< left out
    int duplicate_faces = 0;  ///< left out: they have the corners of another face, or are the other
                              ///< two triangles of a square that is there from both sides
    int cut_edges = 0;        ///< that had more than two faces: the two that continue each other
                              ///< best stay together, others are cut off
    int split_vertices = 0;   ///< new ones, where parts met in a vertex alone or were cut off
    int turned_faces = 0;     ///< so that neighbours agree on what is outside
    int one_sided_pieces = 0;  ///< Moebius strips: there is no such agreement
};

/// Makes a surface manifold and consistently oriented. A piece is turned the way that most of its
/// faces were; which way is out of the body is another question, see turn_outwards().
///
/// A face has no area if it is lower than a millionth of its longest edge, or smaller than
/// validate_mesh() allows.
/// @param mesh  welded, see weld_mesh(); its vertices are finite and its corners in range
/// @param name  of the garment or its file, for messages
/// @throws ArgumentError if no face is left, or if an edge still has more than two faces because
///         what it joins cannot be told apart; the message names its place
RepairedMesh repair_mesh(const TriMesh& mesh, const std::string& name = "garment");

}  // namespace cloth
