#include "demos/many_characters/options.h"

#include <CLI/CLI.hpp>

#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"

namespace cloth {
namespace {

const char* const explanations =
    "The characters stand beside each other in one Bullet world, and move by different clips,\n"
    "or at different times. Each solver steps two such worlds, in turns frame by frame: in one\n"
    "the garments are stepped one after the other, in the other at the same time.\n"
    "\n"
    "  ms_median, ms_p95       time of a world step, animation left out\n"
    "  characters_per_frame    how many of them there could be in a frame of 1/30 s\n"
    "  memory_mb               of each character: resident memory after the first steps, less\n"
    "                          that without characters, over their number\n"
    "  another_mb              of each further one: that of all, less that of one, over the "
    "others\n"
    "  same_bits               all nodes are in both worlds where they are in the other\n";

}  // namespace

ManyCharactersOptions parse_many_characters_options(const std::vector<std::string>& arguments) {
    ManyCharactersOptions options;
    CLI::App app("many_characters: dressed characters in one Bullet world", "many_characters");
    set_up(app);
    add_whole_number(app, "--characters", options.characters, 1, 200, "1 to 200 (default 10)");
    add_garment(app, options.garment, "that each wears (default tshirt_1000)");
    add_list(app, "--solvers", options.solvers,
             "default, quasi-newton-K, xpbd-N, NAME or NAME+K of a network,\n"
             "guarded as they ship; without it default,small+3,xpbd-40");
    add_list(app, "--motions", options.motions,
             "numbers of clips or BVH files, which the characters take in turn\n(default: those "
             "of assimp-testmodels and of shared data, if there is any)");
    add_whole_number(app, "--frames", options.frames, 1, 10000, "that are measured (default 30)");
    add_whole_number(app, "--warm-up", options.warm_up, 2, 10000, "frames before (default 60)");
    add_whole_number(app, "--threads", options.threads, 0, 256,
                     "each bound to a core of its own (0: all cores; default)");
    app.add_option("--out", options.out, "where many_characters.json goes")->type_name("DIR");
    app.footer(explanations);
    parse(app, arguments);
    check_garment_name(options.garment);
    return options;
}

}  // namespace cloth
