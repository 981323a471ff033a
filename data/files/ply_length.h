#pragma once

#include <string>

namespace cloth {

/// Walks through a PLY file (ASCII or binary) as its header describes it, because assimp takes a
/// truncated file for a whole one and makes up the rest.
/// @throws LoadError naming the row where the file ends too early
void check_ply_length(const std::string& path);

}  // namespace cloth
