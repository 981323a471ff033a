#include "data/files/import_scene.h"

#include <assimp/Importer.hpp>
#include <filesystem>

#include "data/core/read_file.h"
#include "data/files/mesh_file_check.h"
#include "data/files/vertex_order.h"

namespace cloth {

const aiScene* import_scene(Assimp::Importer& importer, const std::string& path, unsigned flags) {
    check_mesh_file(path);
    if (extension_of(path) == "obj") {
        const std::string text = read_text_file(path);
        if (text.size() < std::filesystem::file_size(path))
            return importer.ReadFileFromMemory(text.data(), text.size(), flags, "obj");
    }
    return importer.ReadFile(path, flags);
}

}  // namespace cloth
