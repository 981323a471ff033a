#pragma once

#include <string>

namespace cloth {

/// Files that hold a mesh in motion.
enum class CacheFormat {
    pc2,          ///< POINTCACHE2: places alone, little-endian
    mdd,          ///< Lightwave's: places and times, big-endian
    usda,         ///< Universal Scene Description as text: faces, too
    obj_sequence  ///< a folder with a whole mesh for each frame
};

/// The format that the ending of the path says; a path without one is the folder of a sequence.
/// @throws ArgumentError naming the endings there are
CacheFormat cache_format(const std::string& path);

/// Where a cache is while it is written: NAME.part.EXT of NAME.EXT. The ending stays, because
/// programs go by it.
std::string unfinished_cache(const std::string& path);

}  // namespace cloth
