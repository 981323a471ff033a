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

std::string asset_file(const std::string& name, const std::string& extension) {
    return asset_path("garments") + "/" + name + extension;
}

/// A garment of one's own, by its path: names of committed garments have no ending.
bool is_path(const std::string& name) {
    return fs::path(name).has_extension();
}

std::string worn_file(const std::string& name) {
    if (!is_path(name)) return asset_file(name, ".worn.obj");
    return fs::path(name).replace_extension(".worn.obj").string();
}

bool have_same_faces(const TriMesh& a, const TriMesh& b) {
    return a.vertices.rows() == b.vertices.rows() && a.faces.rows() == b.faces.rows() &&
           a.faces == b.faces;
}

/// Garments of one recipe differ in their number of vertices: pants_1000 is of pants.json.
bool has_recipe(const std::string& name) {
    const size_t end = name.find_last_not_of("0123456789");
    const bool numbered = end != std::string::npos && end + 1 < name.size() && name[end] == '_';
    return fs::exists(asset_file(numbered ? name.substr(0, end) : name, ".json"));
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
    if (is_path(name)) return load_mesh(name);
    const std::string path = asset_file(name, ".obj");
    if (!fs::exists(path)) {
        std::string names;
        for (const std::string& known : garment_names())
            names += (names.empty() ? "" : ", ") + known;
        throw LoadError(path, "", "there is no such garment", "choose one of " + names);
    }
    return load_mesh(path);
}

PaintedMesh load_painted_garment(const std::string& name,
                                 const std::optional<GoalColours>& colours) {
    if (is_path(name)) return load_painted_mesh(name, "", FacesWithoutArea::refuse, colours);
    return {load_garment_mesh(name), {}, false};
}

Garment load_garment(const std::string& name, const Fabric& fabric) {
    return Garment(fs::path(name).stem().string(), load_garment_mesh(name), fabric);
}

ClothState load_garment_start(const std::string& name) {
    TriMesh mesh = load_garment_mesh(name);
    const std::string path = worn_file(name);
    if (fs::exists(path)) {
        TriMesh worn = load_mesh(path);
        if (!have_same_faces(worn, mesh))
            throw LoadError(path, "", "its faces are not those of " + name,
                            "make both files anew with make_garments");
        mesh = std::move(worn);
    }
    return {mesh.vertices, Points::Zero(mesh.vertices.rows(), 3), 0.0};
}

}  // namespace cloth
