#include "data/files/cache_format.h"

#include <filesystem>

#include "data/core/errors.h"

namespace cloth {

namespace fs = std::filesystem;

CacheFormat cache_format(const std::string& path) {
    const std::string ending = fs::path(path).extension().string();
    if (ending == ".pc2") return CacheFormat::pc2;
    if (ending == ".mdd") return CacheFormat::mdd;
    if (ending == ".usda") return CacheFormat::usda;
    if (ending == ".glb") return CacheFormat::glb;
    if (ending.empty() && !path.empty()) return CacheFormat::obj_sequence;
    throw ArgumentError(
        path, "is no cache: its ending is unknown",
        "let the name end with .pc2, .mdd, .usda or .glb, or give a folder whose name "
        "has no dot, for a sequence of OBJ files");
}

std::string unfinished_cache(const std::string& path) {
    const fs::path whole(path);
    if (whole.extension() == ".glb") return path + ".part.pc2";
    return (whole.parent_path() / whole.stem()).string() + ".part" + whole.extension().string();
}

}  // namespace cloth
