#pragma once

#include <array>
#include <map>
#include <string>

#include "data/core/types.h"

namespace cloth {

/// The ending of a file's name in lower case, without the dot.
std::string extension_of(const std::string& path);

/// The first .dae of a zip archive, "" if there is none.
std::string read_zipped_dae(const std::string& path);

/// Where a position stands in a file, and its value there at full precision.
struct FilePosition {
    int index = 0;
    Vec3 value = Vec3::Zero();
};

/// The positions of one list in a file by the single-precision value that assimp reads them as.
using FilePositions = std::map<std::array<float, 3>, FilePosition>;

/// The position lists of an OBJ (one, named "") or COLLADA file (one per geometry, named by its
/// id), which assimp hands on only in the order of the faces and in single precision. Empty for
/// formats whose vertex order assimp keeps.
std::map<std::string, FilePositions> read_file_positions(const std::string& path);

/// Where in an OBJ or COLLADA file a position that is not finite stands, such as "line 701": assimp
/// numbers the corners of the faces instead. "" for formats whose numbers assimp keeps.
/// @param mesh      the name that assimp gives the mesh
/// @param position  as assimp read it
std::string place_of_bad_position(const std::string& path, const std::string& mesh,
                                  const std::array<float, 3>& position);

}  // namespace cloth
