// make_garments: makes the garments of data/assets/garments from their recipes, or others. See
// --help.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "data/authoring/make_garment.h"
#include "data/authoring/sheet.h"
#include "data/core/paths.h"
#include "data/files/make_folder.h"
#include "data/files/mesh_io.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

using namespace cloth;

namespace {

struct Options {
    std::vector<std::string> garments;
    int vertices = 0;  ///< 0: those of the committed files
    std::string body;  ///< file; empty: the default body
    std::string out;   ///< folder; empty: where the committed garments are
};

const char* const all_garments[] = {"tshirt", "tank_top", "long_top", "shirt",
                                    "pants",  "shorts",   "skirt",    "dress"};

Options parse_options(const std::vector<std::string>& arguments) {
    Options options;
    CLI::App app("make_garments: makes garments from their recipes", "make_garments");
    set_up(app);
    app.add_option("GARMENT", options.garments,
                   "names of garments or recipe files; none: all committed garments")
        ->take_all()
        ->type_name("");
    add_whole_number(app, "--vertices", options.vertices, 500, 60000,
                     "of each garment, 500 to 60000 (default: as committed)");
    app.add_option("--body", options.body,
                   "mesh file of a body to make them for: with the vertices of\n"
                   "the default body, or with all landmarks in the recipe")
        ->type_name("FILE");
    app.add_option("--out", options.out, "folder (default: data/assets/garments)")
        ->type_name("DIR");
    app.footer(
        "Writes NAME.obj and, for garments with a waistband, NAME.worn.obj: where the vertices\n"
        "of NAME.obj are when the body wears it.");
    parse(app, arguments);
    if (options.out.empty()) options.out = asset_path("garments");
    return options;
}

std::string recipe_file(const std::string& garment) {
    if (std::filesystem::path(garment).extension() == ".json") return garment;
    const std::vector<std::string> known(std::begin(all_garments), std::end(all_garments));
    if (std::find(known.begin(), known.end(), garment) == known.end())
        throw UsageError("garment " + garment + ": choose one of " + join_list(known, ", ") +
                         ", or give a recipe file");
    return asset_path("garments/" + garment + ".json");
}

/// The body that garments are made for, and its landmarks as far as they are known.
struct Wearer {
    TriMesh skin;
    BodyLandmarks landmarks;
    bool is_rigged = true;
};

Wearer wearer(const Options& options) {
    const Body body = Body::load_default();
    if (options.body.empty()) return {body.rest_mesh(), body_landmarks(body)};
    const TriMesh skin = load_mesh(options.body);
    if (skin.vertices.rows() != body.rest().rows()) return {skin, {}, false};
    const Body shaped = body.with_rest(skin.vertices);
    return {shaped.rest_mesh(), body_landmarks(shaped)};
}

void save(const Options& options, const std::string& name, const TriMesh& mesh) {
    const std::string path = options.out + "/" + name + ".obj";
    save_obj(path, mesh);
    std::printf("%s: %d vertices, %d faces\n", path.c_str(), static_cast<int>(mesh.vertices.rows()),
                static_cast<int>(mesh.faces.rows()));
    std::fflush(stdout);
}

void make(const Options& options, const Wearer& wearer, const std::string& name,
          GarmentRecipe recipe, int vertices) {
    if (!wearer.is_rigged && static_cast<int>(recipe.landmarks.size()) < BodyLandmarks::count)
        throw UsageError("--body " + options.body + ": it is not of the default body's vertices, " +
                         "so " + name + " needs a recipe with all landmarks");
    recipe.target_vertices = vertices;
    const AuthoredGarment garment = make_garment(wearer.skin, wearer.landmarks, recipe);
    save(options, name, {garment.rest, garment.worn.faces});
    if (recipe.from == GarmentRecipe::From::waist) save(options, name + ".worn", garment.worn);
}

/// A name alone is the garment as its recipe has it; others have their number of vertices in it.
void make_committed(const Options& options, const Wearer& wearer, const std::string& name) {
    const GarmentRecipe recipe = load_garment_recipe(recipe_file(name));
    make(options, wearer, name, recipe, recipe.target_vertices);
    std::vector<int> others = {1000};
    if (name == "tshirt") others = {2000, 1000};
    if (name == "dress") others = {4000, 1000};
    for (const int vertices : others)
        make(options, wearer, name + "_" + std::to_string(vertices), recipe, vertices);
}

/// A cape behind the shoulders of the person of X/BCN_Epileptic.X: a sheet that hangs down
/// and widens from 0.2 m at the neck to 0.6 m.
void make_cape(const Options& options) {
    const TriMesh sheet = make_sheet(0.4, 0.85, 700);
    TriMesh cape = sheet;
    const VectorX width = 1.0 + sheet.vertices.col(2).array() / 0.85;
    cape.vertices.col(0) = -sheet.vertices.col(0).cwiseProduct(width);
    cape.vertices.col(1) = -0.01 - sheet.vertices.col(2).array();
    cape.vertices.col(2) = -0.30 - sheet.vertices.col(1).array();
    save(options, "cape", cape);
}

void make_garments(const Options& options) {
    make_folder(options.out);
    const Wearer person = wearer(options);
    if (options.garments.empty()) {
        for (const char* name : all_garments) make_committed(options, person, name);
        make_cape(options);
    }
    for (const std::string& garment : options.garments) {
        const std::string name = std::filesystem::path(garment).stem().string();
        const GarmentRecipe recipe = load_garment_recipe(recipe_file(garment));
        make(options, person, name, recipe,
             options.vertices > 0 ? options.vertices : recipe.target_vertices);
    }
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        make_garments(parse_options(arguments));
    });
}
