#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// A mesh whose vertices at one place are one vertex.
struct WeldedMesh {
    TriMesh mesh;
    std::vector<int> kept;    ///< |mesh.vertices|: the vertex of the original, ascending
    std::vector<int> target;  ///< for each vertex of the original, that of the original which it
                              ///< became: itself, or an earlier one
    int merged = 0;           ///< vertices that became one with another
    int dropped_faces = 0;    ///< faces that lost their area: two of their corners became one
};

/// Makes vertices that lie within `tolerance` of each other one, as files need it that repeat
/// vertices along seams of textures or between parts. The first of them in the order of the file
/// stays where it is; vertices that no face uses are left out.
///
/// @param tolerance  (m), 0 to 0.01; 0 joins vertices at exactly the same place
/// @throws ArgumentError if the tolerance is out of range, a vertex is not finite or beyond 1e9 m,
/// or
///         a face refers to a vertex that does not exist
WeldedMesh weld_mesh(const TriMesh& mesh, double tolerance);

}  // namespace cloth
