#include "demos/bake/options.h"

#include <CLI/CLI.hpp>

#include "data/files/cache_format.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

void add_scene(CLI::App& app, BakeOptions& options) {
    add_garment(app, options.garment, "what is worn (default tshirt)");
    app.add_option("--motion", options.motion,
                   "01_01 (default), 01_03, Boxing_Toes, a BVH file; of a --character, the\n"
                   "name of its animation (default: the first)")
        ->type_name("NAME");
    app.add_option("--fabric", options.fabric, "soft cotton (default), or cotton as measured")
        ->check(CLI::IsMember({"soft", "real"}).description(""))
        ->type_name("soft|real");
    app.add_option("--solver", options.solver,
                   "quasi-newton (default), small, xpbd-40, reference and the others that\n"
                   "compare --help names")
        ->type_name("NAME");
}

/// As those of hello_character.
void add_character(CLI::App& app, CharacterSceneSettings& character) {
    app.add_option("--character", character.character,
                   "rigged and animated file (.glb, .fbx, ...) that wears a mesh file,\n"
                   "instead of the project's body")
        ->type_name("FILE");
    app.add_option("--skin", character.skin.mesh_name, "its mesh that is skin (default: all)")
        ->type_name("NAME");
    app.add_option("--character-scale", character.skin.scale, "metres per unit of the file");
    app.add_option("--garment-scale", character.garment_scale, "metres per unit of the file");
    app.add_option("--weld", character.weld, "vertices as near as this become one (m)");
    app.add_option("--clearance", character.clearance, "from skin to cloth at the start (m)");
    app.add_option("--pin", character.pin, "lowest and highest vertex that rides on the skin (m)")
        ->expected(2);
    app.add_option("--settle", character.settle, "its first pose is held for so long (s)");
}

void add_cache(CLI::App& app, BakeOptions& options) {
    add_whole_number(app, "--rate", options.rate, 10, 240,
                     "frames per second, and steps (default 30, which networks need)");
    add_whole_number(app, "--frames", options.frames, 0, 1000000,
                     "frames in the cache (default 0: the whole motion)");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores");
    app.add_option("--out", options.out,
                   "the garment's cache: NAME.pc2, NAME.mdd, NAME.usda, or a folder for a\n"
                   "sequence of OBJ files; NAME_rest.obj is the mesh that it belongs to")
        ->type_name("FILE");
    app.add_option("--body", options.body, "the moving body's cache, in the same way")
        ->type_name("FILE");
    app.add_flag("--resume", options.resume,
                 "go on with a run that was interrupted; give the same options");
}

void check(BakeOptions& options) {
    if (options.out.empty()) throw UsageError("--out: name a file; see --help");
    if (options.frames == 1) throw UsageError("--frames: give 0 or at least 2");
    if (options.out == options.body) throw UsageError("--body: give another file than --out");
    cache_format(options.out);
    if (!options.body.empty()) cache_format(options.body);
    if (options.character.character.empty()) {
        if (options.motion.empty()) options.motion = "01_01";
        return check_garment_name(options.garment);
    }
    CharacterSceneSettings& character = options.character;
    if (!character.pin.empty() && character.pin.size() != 2)
        throw UsageError("--pin: give the lowest and the highest height");
    character.garment = options.garment;
    character.skin.animation = options.motion;
    character.fabric = options.fabric;
    character.rate = options.rate;
    character.steps = options.frames == 0 ? 0 : options.frames - 1;
}

}  // namespace

BakeOptions parse_bake_options(const std::vector<std::string>& arguments) {
    BakeOptions options;
    CLI::App app("bake: a garment on a moving body, written to a cache that modellers read",
                 "bake");
    set_up(app);
    add_scene(app, options);
    add_character(app, options.character);
    add_cache(app, options);
    app.footer(
        "Ctrl-C ends a run after the frame that is computed. What is there is called\n"
        "NAME.part.pc2 and so on until it is whole, and can be read.");
    parse(app, arguments);
    check(options);
    return options;
}

}  // namespace cloth
