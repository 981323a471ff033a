#include "demos/bake/scene_options.h"

#include <CLI/CLI.hpp>

#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

/// What says nothing of the project's body must not be left out in silence.
void refuse_without_character(CLI::App& app, const SceneOptions& options,
                              const std::vector<std::string>& names) {
    app.parse_complete_callback([&app, &options, names] {
        if (!options.character.character.empty()) return;
        for (const std::string& name : names)
            if (app.count(name) > 0)
                throw UsageError(name +
                                 ": it is for a --character and its garment; give one, or "
                                 "leave " +
                                 name + " out");
    });
}

/// As those of hello_character.
void add_character(CLI::App& app, SceneOptions& options) {
    CharacterSceneSettings& character = options.character;
    app.add_option("--character", character.character,
                   "file (.glb, .fbx, ...) of a rigged and animated character, or of one that\n"
                   "stands, that wears a mesh file instead of the project's body")
        ->type_name("FILE");
    app.add_option("--skin", character.skin.mesh_name, "its mesh that is skin (default: all)")
        ->type_name("NAME");
    app.add_option("--character-scale", character.skin.scale, "metres per unit of the file");
    app.add_option("--garment-scale", character.garment_scale, "metres per unit of the file");
    add_hint(app, "--unit",
             "import_garment converts units, and writes metres; here give --garment-scale and "
             "--character-scale, the metres per unit of the files");
    app.add_option("--weld", character.weld, "vertices as near as this become one (m)");
    app.add_option("--clearance", character.clearance, "from skin to cloth at the start (m)");
    app.add_option("--pin", character.pin, "lowest and highest vertex that rides on the skin (m)")
        ->expected(2);
    app.add_option("--goal-colours", options.goal_colours,
                   "read its garment's vertex colours as goals: red 0 is held by the skin, red\n"
                   "just below 1 may be so far from it (m, 0.001 to 10), red 1 is free. Goals\n"
                   "in attributes of its file are always read")
        ->type_name("M");
    app.add_option("--settle", character.settle, "its first pose is held for so long (s)");
    refuse_without_character(app, options,
                             {"--skin", "--character-scale", "--garment-scale", "--weld",
                              "--clearance", "--pin", "--goal-colours", "--settle"});
}

}  // namespace

void add_scene(CLI::App& app, SceneOptions& options) {
    add_garment(app, options.garment, "what is worn (default tshirt)");
    app.add_option("--motion", options.motion,
                   "01_01 (default), 01_03, Boxing_Toes, a BVH file; of a --character, the\n"
                   "name of its animation (default: the first)")
        ->type_name("NAME");
    app.add_option("--fabric", options.fabric, "soft cotton (default), or cotton as measured")
        ->check(CLI::IsMember({"soft", "real"}).description(""))
        ->type_name("soft|real");
    app.add_option("--solver", options.solver,
                   "default (the library's), small, xpbd-40, reference and the others that\n"
                   "compare --help names")
        ->type_name("NAME");
    add_whole_number(app, "--rate", options.rate, 10, 240,
                     "frames per second, and steps (default 30, for which most networks\nare)");
    add_character(app, options);
}

void finish_scene(SceneOptions& options) {
    if (options.character.character.empty()) {
        if (options.motion.empty()) options.motion = "01_01";
        return check_garment_name(options.garment);
    }
    CharacterSceneSettings& character = options.character;
    if (!character.pin.empty() && character.pin.size() != 2)
        throw UsageError("--pin: give the lowest and the highest height");
    character.garment = options.garment;
    if (options.goal_colours) {
        character.goal_colours.emplace();
        character.goal_colours->max_distance = *options.goal_colours;
        character.goal_colours->check();
    }
    character.skin.animation = options.motion;
    character.fabric = options.fabric;
    character.rate = options.rate;
    character.steps = options.frames == 0 ? 0 : options.frames - 1;
}

}  // namespace cloth
