#include "demos/scaling/sized_scene.h"

#include <filesystem>

#include "data/authoring/make_garment.h"
#include "data/core/paths.h"
#include "data/files/make_folder.h"
#include "data/files/mesh_io.h"
#include "demos/speed_error/scenes.h"

namespace cloth {
namespace {

/// Path of the garment's mesh, made if it is not there.
std::string garment_file(const SizedSceneSettings& settings) {
    const std::string path =
        settings.work + "/" + settings.name + "_" + std::to_string(settings.vertices) + ".obj";
    if (std::filesystem::exists(path)) return path;
    make_folder(settings.work);
    GarmentRecipe recipe = load_garment_recipe(asset_path("garments/" + settings.name + ".json"));
    recipe.target_vertices = settings.vertices;
    save_obj(path, make_garment(Body::load_default(), recipe).worn);
    return path;
}

}  // namespace

std::vector<std::string> scaling_scenes() {
    return {"sphere", "dress"};
}

std::unique_ptr<ComparisonScene> make_sized_scene(const SizedSceneSettings& settings) {
    SceneSettings scene;
    scene.name = settings.name == "dress" ? garment_file(settings) : settings.name;
    scene.frames = settings.frames;
    scene.vertices = settings.vertices;
    return make_scene(scene);
}

}  // namespace cloth
