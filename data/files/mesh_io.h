#pragma once

#include <string>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// What load_mesh() does with a face whose corners are in one line.
enum class FacesWithoutArea {
    refuse,  ///< LoadError
    keep     ///< as the file has it, for who repairs the mesh: see repair_mesh()
};

/// Reads a triangle surface from OBJ, PLY, glTF or COLLADA (.dae, zipped .zae).
///
///     TriMesh skin = load_mesh("human.zae", "human-baseMesh");  // without the eyes
///
/// Polygons are triangulated. Vertices at exactly the same position are one vertex; otherwise they
/// keep the order and (OBJ, COLLADA) the full precision of the file, whatever order the faces use
/// them in, so that skin weights and pins may refer to them by number. Vertices of no face are left
/// out. Node transforms, units and the up axis of the file are applied: metres, Y up.
///
/// @param mesh_name  the mesh or node to read; empty: all of them, one after the other
/// @throws LoadError if the file is missing, truncated or empty, has no mesh of that name, or has a
///         vertex that is not finite, a face without area or an index that is out of range
TriMesh load_mesh(const std::string& path, const std::string& mesh_name = "",
                  FacesWithoutArea without_area = FacesWithoutArea::refuse);

/// The names of the meshes in a file, in alphabetical order; those without a name are left out.
/// @throws LoadError if the file is missing, or cannot be read
std::vector<std::string> mesh_names(const std::string& path);

/// Writes an OBJ that load_mesh() reads back bit by bit. The file appears whole or not at all: it
/// is written under a temporary name and renamed.
/// @throws LoadError if the file cannot be written
void save_obj(const std::string& path, const TriMesh& mesh);

}  // namespace cloth
