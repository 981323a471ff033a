#pragma once

#include <string>

namespace cloth {

/// Looks through a mesh file before assimp does, which crashes on or makes memory for what damaged
/// files say: counts beyond the file, archives whose parts do not unpack, values nested without
/// end, glTF skins without binding matrices, PLY files that are cut.
/// @throws LoadError if there is no such file, it is a folder or empty, or has one of these
void check_mesh_file(const std::string& path);

}  // namespace cloth
