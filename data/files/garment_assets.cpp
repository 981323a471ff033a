#include "data/files/garment_assets.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"

namespace cloth {

namespace {

namespace fs = std::filesystem;

std::string garment_file(const std::string& name, const std::string& extension) {
    return asset_path("garments") + "/" + name + extension;
}

/// Garments of one recipe differ in their number of vertices: pants_1000 is of pants.json.
bool has_recipe(const std::string& name) {
    const size_t end = name.find_last_not_of("0123456789");
    const bool numbered = end != std::string::npos && end + 1 < name.size() && name[end] == '_';
    return fs::exists(garment_file(numbered ? name.substr(0, end) : name, ".json"));
}

}  // namespace

std::vector<std::string> garment_names() {
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator(asset_path("garments"))) {
        const std::string name = file.path().stem().string();
        if (file.path().extension() == ".obj" && has_recipe(name)) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

TriMesh load_garment_mesh(const std::string& name) {
    const std::string path = garment_file(name, ".obj");
    if (!fs::exists(path)) {
        std::string names;
        for (const std::string& known : garment_names())
            names += (names.empty() ? "" : ", ") + known;
        throw LoadError(path, "", "there is no such garment", "choose one of " + names);
    }
    return load_mesh(path);
}

Garment load_garment(const std::string& name, const Fabric& fabric) {
    return Garment(name, load_garment_mesh(name), fabric);
}

ClothState load_garment_start(const std::string& name) {
    TriMesh mesh = load_garment_mesh(name);
    const std::string path = garment_file(name, ".worn.obj");
    if (fs::exists(path)) {
        TriMesh worn = load_mesh(path);
        if (worn.faces != mesh.faces)
            throw LoadError(path, "", "its faces are not those of " + name + ".obj",
                            "make both files anew with make_garments");
        mesh = std::move(worn);
    }
    return {mesh.vertices, Points::Zero(mesh.vertices.rows(), 3), 0.0};
}

}  // namespace cloth
