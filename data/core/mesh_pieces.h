#pragma once

#include <string>
#include <utility>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// |F|: number of the connected piece that each face belongs to, from 0 in the order of faces.
/// Faces are connected if they share a vertex.
std::vector<int> face_pieces(const Faces& faces);

/// How many pieces there are.
int piece_count(const std::vector<int>& face_pieces);

/// The faces for which `keep` (|F|) is not 0, and the vertices that they use, in their order.
TriMesh keep_faces(const TriMesh& mesh, const std::vector<char>& keep);

/// One of the pieces.
TriMesh piece_of(const TriMesh& mesh, const std::vector<int>& face_pieces, int piece);

/// Edges (from, to) that one face alone has, in the direction of that face, sorted.
std::vector<std::pair<int, int>> border_edges(const Faces& faces);

/// The part of a surface's edges that have one face alone: 0 if it is closed.
double border_share(const Faces& faces);

/// Volume that a closed surface encloses (m^3): negative if its faces look inwards. (Divergence
/// theorem, a tetrahedron for each face.) Of an open surface it is that of the cones from the mean
/// of its vertices.
double signed_volume(const TriMesh& mesh);

/// @throws ArgumentError naming `name` unless cloth can be kept off this surface: where
///         validate_mesh() does, and if its faces look inwards, which puts outside in
void validate_skin(const std::string& name, const TriMesh& skin);

}  // namespace cloth
