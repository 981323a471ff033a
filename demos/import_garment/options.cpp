#include "demos/import_garment/options.h"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "data/core/check_range.h"
#include "data/core/length_units.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_named.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

struct Units {
    std::string garment, character, up;
    double goal_colours = 0.0;
    std::vector<double> move;
};

void add_garment_file(CLI::App& app, ImportOptions& options, Units& units) {
    app.add_option("FILE", options.file,
                   "the garment: OBJ, PLY, glTF, COLLADA, or MakeHuman's .mhclo with its OBJ\n"
                   "file beside it")
        ->type_name("")
        ->required();
    app.add_option("--mesh", options.mesh, "the mesh of the file that it is (default: all)")
        ->type_name("NAME");
    auto* scale = app.add_option("--scale", options.scale, "metres per unit of the file");
    app.add_option("--unit", units.garment, "the unit of the file: m (default), cm, mm, dm, in, ft")
        ->type_name("U")
        ->excludes(scale);
    app.add_option("--up", units.up,
                   "the axis that points up in the file: y (default) or z; if it is given,\n"
                   "garments that lie beside the character are taken, too")
        ->check(CLI::IsMember({"y", "z"}).description(""))
        ->type_name("y|z");
    app.add_option("--move", units.move, "then by so much (m)")->expected(3)->type_name("X Y Z");
}

void add_paint(CLI::App& app, Units& units) {
    app.add_option("--goal-colours", units.goal_colours,
                   "read vertex colours as goals, as bake does, and carry them over; red just\n"
                   "below 1 is so far from the skin (m). Goals in attributes always are")
        ->type_name("M");
}

void add_wearer(CLI::App& app, ImportOptions& options, Units& units) {
    auto* character =
        app.add_option("--character", options.character,
                       "rigged file (.glb, .fbx, ...) that the garment was modelled on")
            ->type_name("FILE");
    app.add_option("--skin", options.skin.mesh_name, "its mesh that is skin (default: all)")
        ->type_name("NAME")
        ->needs(character);
    auto* scale = app.add_option("--character-scale", options.skin.scale,
                                 "metres per unit of its file, where it does not say itself")
                      ->needs(character);
    app.add_option("--character-unit", units.character, "the same by name, as --unit")
        ->type_name("U")
        ->excludes(scale)
        ->needs(character);
    app.add_option("--body", options.body,
                   "instead of --character the project's body: default, slight, heavy, or the\n"
                   "number of a sampled shape. The garment is written for the body default,\n"
                   "from which compare --body fits it to every other one")
        ->type_name("NAME")
        ->excludes(character);
}

void add_work(CLI::App& app, GarmentImportSettings& work) {
    app.add_option("--weld", work.weld,
                   "vertices as near as this become one (m, default 0.0001, to 0.01)")
        ->type_name("M");
    add_whole_number(app, "--vertices", work.vertices, 0, 60000,
                     "remesh each garment to so many, 500 to 60000 (default 0: do not)");
    app.add_option("--clearance", work.clearance, "from skin to cloth (m, default 0.0045)")
        ->type_name("M");
    app.add_option("--most-inside", work.most_inside,
                   "refuse it if more than this part starts inside the skin (default 0.5)")
        ->type_name("P");
    app.add_option("--smallest-piece", work.smallest_piece,
                   "leave out pieces of less than this part of the area (default 0.03)")
        ->type_name("P");
    app.add_flag("--together", work.together, "pieces that do not touch are one garment");
    app.add_option("--band-ratio", work.band_ratio,
                   "length of a waistband at rest by that worn, 0.5 to 1 (default 0.7);\n"
                   "1: no waistband, the garment keeps all its lengths")
        ->type_name("R");
}

void check(ImportOptions& options, const Units& units) {
    if (!units.garment.empty()) options.scale = length_unit(units.garment).metres;
    if (!units.character.empty()) options.skin.scale = length_unit(units.character).metres;
    if (!units.move.empty() && units.move.size() != 3)
        throw UsageError("--move: give three numbers");
    if (!units.move.empty()) options.move = Vec3(units.move[0], units.move[1], units.move[2]);
    options.z_up = units.up == "z";
    options.up_is_given = !units.up.empty();
    check_range("--scale", options.scale, 1e-6, 1e6);
    for (int axis = 0; axis < 3; ++axis) check_range("--move", options.move[axis], -1e3, 1e3);
    if (units.goal_colours != 0.0) {
        options.goal_colours.emplace();
        options.goal_colours->max_distance = units.goal_colours;
        options.goal_colours->check();
    }
    options.import.check();
    options.import.garment_name = options.file;
    options.import.skin_name =
        options.character.empty() ? "the body " + options.body : options.character;
    if (options.name.empty()) options.name = std::filesystem::path(options.file).stem().string();
    if (options.name.empty() || options.name.find_first_of("/+") != std::string::npos)
        throw UsageError("--name " + options.name + ": give a name without / and +");
    if (options.character.empty()) body_shape_named(options.body);
    for (const char* const ending : {".obj", ".ply"}) {
        const std::filesystem::path result = options.out + "/" + options.name + ending;
        std::error_code none;
        if (std::filesystem::equivalent(result, options.file, none))
            throw UsageError("--out " + options.out + ": " + options.file +
                             " would be overwritten; give another folder or --name");
    }
}

}  // namespace

ImportOptions parse_import_options(const std::vector<std::string>& arguments) {
    ImportOptions options;
    Units units;
    CLI::App app("import_garment: a garment that can be simulated, of somebody's mesh",
                 "import_garment");
    set_up(app);
    add_garment_file(app, options, units);
    add_paint(app, units);
    add_wearer(app, options, units);
    add_work(app, options.import);
    app.add_option("--name", options.name, "of the garment (default: that of the file)")
        ->type_name("NAME");
    app.add_option("--out", options.out, "folder (default out/import)")->type_name("DIR");
    bool no_picture = false;
    app.add_flag("--no-picture", no_picture, "write the meshes and the report only");
    app.footer(
        "Writes NAME.obj, and for what sits on a waist NAME.worn.obj: where the vertices of\n"
        "NAME.obj are when it is worn. If goals are painted on it, NAME.ply is written in\n"
        "place of NAME.obj, with them. A file with several pieces gives NAME_top.obj,\n"
        "NAME_trousers.obj and so on. NAME.import.json and NAME.import.txt say what was found\n"
        "and done, NAME.import.png shows it before and after.");
    parse(app, arguments);
    options.picture = !no_picture;
    check(options, units);
    return options;
}

}  // namespace cloth
