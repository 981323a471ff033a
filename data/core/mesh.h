#pragma once

#include <array>
#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Triangle surface: vertices (|V| x 3, m) and faces (|F| x 3, counter-clockwise seen from
/// outside).
struct TriMesh {
    Points vertices;
    Faces faces;
};

/// Area vectors of the faces (|F| x 3): the normal times the area (m^2).
Points face_area_vectors(const Points& vertices, const Faces& faces);

/// Unit face normals (|F| x 3); zero for a face without area.
Points face_normals(const Points& vertices, const Faces& faces);

/// Unit vertex normals weighted by face area (|V| x 3); zero for a vertex without faces.
Points vertex_normals(const Points& vertices, const Faces& faces);
/// The same into `normals`, whose memory is used again.
void vertex_normals(const Points& vertices, const Faces& faces, Points& normals);

/// Undirected edges (i < j), sorted, each once.
std::vector<std::array<int, 2>> undirected_edges(const Faces& faces);

/// Throws ArgumentError, naming `name`, unless the mesh has finite vertices, indices in range, no
/// face without area and no edge with more than two faces.
void validate_mesh(const std::string& name, const TriMesh& mesh);

}  // namespace cloth
