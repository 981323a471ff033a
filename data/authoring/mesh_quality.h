#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// Smallest angle of one triangle (degrees).
double smallest_angle(const Points& vertices, const Eigen::RowVector3i& face);

/// Smallest angle of all triangles (degrees).
double smallest_angle(const TriMesh& mesh);

/// Mean number of edges of the vertices that are not on a border.
double mean_inner_degree(const TriMesh& mesh);

/// The borders of a surface, each a closed loop of vertices in the direction of its faces' edges.
/// @throws ArgumentError if a border passes twice through one vertex
std::vector<std::vector<int>> boundary_loops(const Faces& faces);

/// What a surface is as a whole.
struct Topology {
    int components = 0;
    int boundary_loops = 0;
    int euler_characteristic = 0;  ///< |V| - |E| + |F| of the vertices that faces use
    bool manifold = true;          ///< every vertex has one fan of faces, every edge at most two
    bool oriented = true;          ///< neighbours agree on what is outside
};

Topology topology(const Faces& faces);

}  // namespace cloth
