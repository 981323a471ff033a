// Makes the garments of data/assets/garments from their recipes:
//     make_garments [OUTPUT_FOLDER]    (default: data/assets/garments)

#include <cstdio>
#include <exception>
#include <string>
#include <utility>

#include "data/authoring/sheet.h"
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

/// A cape behind the shoulders of the person of X/BCN_Epileptic.X: a sheet that hangs down
/// and widens from 0.2 m at the neck to 0.6 m.
static void make_cape(const std::string& folder) {
    const TriMesh sheet = make_sheet(0.4, 0.85, 700);
    TriMesh cape = sheet;
    const VectorX width = 1.0 + sheet.vertices.col(2).array() / 0.85;
    cape.vertices.col(0) = -sheet.vertices.col(0).cwiseProduct(width);
    cape.vertices.col(1) = -0.01 - sheet.vertices.col(2).array();
    cape.vertices.col(2) = -0.30 - sheet.vertices.col(1).array();
    save_obj(folder + "/cape.obj", cape);
    std::printf("%s/cape.obj: %d vertices, %d faces\n", folder.c_str(),
                static_cast<int>(cape.vertices.rows()), static_cast<int>(cape.faces.rows()));
}

int main(int argc, char** argv) {
    try {
        const std::string folder = argc > 1 ? argv[1] : asset_path("garments");
        make_tshirts(folder);
        make_cape(folder);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_garments: %s\n", error.what());
        return 1;
    }
}
