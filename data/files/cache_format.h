#pragma once

#include <string>

namespace cloth {

/// Files that hold a mesh in motion.
enum class CacheFormat {
    pc2,          ///< POINTCACHE2: places alone, little-endian
    mdd,          ///< Lightwave's: places and times, big-endian
    glb,          ///< glTF 2.0: faces, and a morph target for each frame
    usda,         ///< Universal Scene Description as text: faces, too
    obj_sequence  ///< a folder with a whole mesh for each frame
};

/// The format that the ending of the path says; a path without one is the folder of a sequence.
/// @throws ArgumentError naming the endings there are
CacheFormat cache_format(const std::string& path);

/// Where a cache is while it is written: NAME.part.EXT of NAME.EXT. The ending stays, because
/// programs go by it. The frames of NAME.glb are in a point cache, NAME.glb.part.pc2.
std::string unfinished_cache(const std::string& path);

}  // namespace cloth
