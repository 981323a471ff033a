#include "demos/bake/options.h"

#include <CLI/CLI.hpp>

#include "data/files/cache_format.h"
#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

void add_cache(CLI::App& app, BakeOptions& options) {
    add_whole_number(app, "--frames", options.frames, 0, 1000000,
                     "frames in the cache (default 0: the whole motion)");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores");
    app.add_option("--out", options.out,
                   "the garment's cache: NAME.pc2, .mdd, .usda or .glb, or a folder for a\n"
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
    finish_scene(options);
}

}  // namespace

BakeOptions parse_bake_options(const std::vector<std::string>& arguments) {
    BakeOptions options;
    CLI::App app("bake: a garment on a moving body, written to a cache that modellers read",
                 "bake");
    set_up(app);
    add_scene(app, options);
    add_cache(app, options);
    app.footer(
        "Ctrl-C ends a run after the frame that is computed. What is there is called\n"
        "NAME.part.pc2 and so on until it is whole, and can be read.");
    parse(app, arguments);
    check(options);
    return options;
}

}  // namespace cloth
