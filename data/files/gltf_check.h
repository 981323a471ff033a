#pragma once

#include <string>

namespace cloth {

/// Refuses glTF 2.0 files with broken faces, skins or animations. assimp leaves such parts out
/// without a word: faces of vertices that do not exist, the weights of a vertex, or a whole
/// channel, so that a limb stays behind. What is stored sparsely or compressed is not looked at.
/// @throws LoadError naming mesh, vertex or channel
void check_gltf_parts(const std::string& path);

}  // namespace cloth
