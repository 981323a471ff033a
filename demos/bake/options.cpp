#include "demos/bake/options.h"

#include <CLI/CLI.hpp>
#include <filesystem>

#include "data/body/outfit.h"
#include "data/files/cache_format.h"
#include "demos/bake/bake.h"
#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"
#include "demos/dressing_checks.h"

namespace cloth {

namespace fs = std::filesystem;

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

/// One path for a file, whatever way it is named.
fs::path normalised(const std::string& path) {
    std::error_code error;
    fs::path one = fs::weakly_canonical(fs::absolute(path), error);
    if (error) one = fs::absolute(path).lexically_normal();
    return one.has_filename() ? one : one.parent_path();
}

/// Neither cache may be written over the other one, nor over its mesh.
void check_caches_differ(const BakeOptions& options) {
    if (normalised(options.out) == normalised(options.body))
        throw UsageError("--body " + options.body + ": give another file than --out");
    for (const std::string& file : cache_files(options.body))
        for (const std::string& other : cache_files(options.out))
            if (normalised(file) == normalised(other))
                throw UsageError("--body " + options.body + ": " + file +
                                 " would be written for --out " + options.out +
                                 ", too; give a file of another name");
}

/// What is read stays as it is.
void check_inputs_stay(const BakeOptions& options) {
    std::vector<std::string> inputs = outfit_parts(options.garment);
    inputs.push_back(options.character.character);
    inputs.push_back(options.motion);
    check_not_overwritten("--out " + options.out, cache_files(options.out), inputs,
                          "give a file of another name");
    if (!options.body.empty())
        check_not_overwritten("--body " + options.body, cache_files(options.body), inputs,
                              "give a file of another name");
}

void check(BakeOptions& options) {
    if (options.out.empty()) throw UsageError("--out: name a file; see --help");
    if (options.frames == 1) throw UsageError("--frames: give 0 or at least 2");
    cache_format(options.out);
    if (!options.body.empty()) {
        cache_format(options.body);
        check_caches_differ(options);
    }
    finish_scene(options);
    check_inputs_stay(options);
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
