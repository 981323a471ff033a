#include "demos/scaling/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"
#include "demos/scaling/sized_scene.h"

namespace cloth {
namespace {

const char* const explanations =
    "For each scene and number of vertices the garment is made anew, the solvers are made,\n"
    "and take turns frame by frame in this process.\n"
    "\n"
    "  ms_median, ms_p95     time of a frame\n"
    "  us_per_vertex         its median, over the number of vertices\n"
    "  stages_ms             its median by stage, as solvers report it\n"
    "  setup_ms              making the solver, and its first step\n"
    "  memory_mb             highest resident memory while the solver was made and stepped\n"
    "                        twice, less that before\n"
    "\n"
    "Garments are kept in DIR/garments. Results are written after each size.";

void check_scenes(const std::vector<std::string>& scenes) {
    const std::vector<std::string> known = scaling_scenes();
    for (const std::string& scene : scenes)
        if (std::find(known.begin(), known.end(), scene) == known.end())
            throw UsageError("--scenes " + scene + ": choose of " + join_list(known, ", "));
}

}  // namespace

ScalingOptions parse_scaling_options(const std::vector<std::string>& arguments) {
    ScalingOptions options;
    std::vector<std::string> vertices;
    CLI::App app("scaling: time and memory of solvers against the number of vertices", "scaling");
    set_up(app);
    add_list(app, "--scenes", options.scenes,
             "sphere (a sheet falls on it), dress (on a body, motion 01_01);\ndefault: both");
    add_list(app, "--vertices", vertices,
             "500 to 60000 each (default 1000,2000,4000,8000,12000,25000,\n50000)");
    add_list(app, "--solvers", options.solvers,
             "as speed_error knows them; without it default,small+3,\nxpbd-40");
    add_whole_number(app, "--frames", options.frames, 1, 1000, "that are measured (default 12)");
    add_whole_number(app, "--warm-up", options.warm_up, 0, 1000, "frames before them (default 3)");
    add_whole_number(app, "--threads", options.threads, 0, 256,
                     "each bound to a core of its own (0: all cores; default)");
    app.add_option("--out", options.out, "where scaling.json and scaling.svg go")->type_name("DIR");
    app.footer(explanations);
    parse(app, arguments);
    check_scenes(options.scenes);
    if (!vertices.empty()) options.vertices.clear();
    for (const std::string& number : vertices)
        options.vertices.push_back(whole_number("--vertices", number, 500, 60000));
    return options;
}

}  // namespace cloth
