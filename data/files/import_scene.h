#pragma once

#include <string>

struct aiScene;
namespace Assimp {
class Importer;
}

namespace cloth {

/// Lets assimp read a file after check_mesh_file() has looked through it. The byte order mark of an
/// OBJ file is left out: assimp takes it for a part of the first line, and so loses a vertex.
/// @param flags  post-processing steps of assimp
/// @return  null: see importer.GetErrorString()
/// @throws LoadError as check_mesh_file()
const aiScene* import_scene(Assimp::Importer& importer, const std::string& path, unsigned flags);

}  // namespace cloth
