// Makes the garments of data/assets/garments from their recipes:
//     make_garments [OUTPUT_FOLDER]    (default: data/assets/garments)

#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include "data/authoring/tshirt.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"

using namespace cloth;

static void make_tshirts(const std::string& folder) {
    const TriMesh body = load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    TshirtRecipe recipe = load_tshirt_recipe(asset_path("garments/tshirt.json"));
    const std::pair<const char*, int> files[] = {{"tshirt.obj", recipe.target_vertices},
                                                 {"tshirt_2000.obj", 2000},
                                                 {"tshirt_1000.obj", 1000}};
    for (const auto& [name, vertices] : files) {
        recipe.target_vertices = vertices;
        const TriMesh shirt = make_tshirt(body, recipe);
        save_obj(folder + "/" + name, shirt);
        std::printf("%s/%s: %d vertices, %d faces\n", folder.c_str(), name,
                    static_cast<int>(shirt.vertices.rows()), static_cast<int>(shirt.faces.rows()));
    }
}

int main(int argc, char** argv) {
    try {
        make_tshirts(argc > 1 ? argv[1] : asset_path("garments"));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_garments: %s\n", error.what());
        return 1;
    }
}
