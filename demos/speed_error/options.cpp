#include "demos/speed_error/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"
#include "demos/speed_error/scenes.h"

namespace cloth {
namespace {

/// An option that chooses one of some things, or all of them.
void add_choice(CLI::App& app, const std::string& name, std::vector<std::string>& chosen,
                const std::vector<std::string>& choices, const std::string& all,
                const std::string& description) {
    std::vector<std::string> names = choices;
    names.push_back(all);
    const auto choose = [&chosen, choices, all](const std::string& value) {
        chosen = value == all ? choices : std::vector<std::string>{value};
    };
    app.add_option_function<std::string>(name, choose, description)
        ->check(CLI::IsMember(names).description(""))
        ->type_name("NAME");
}

const char* const explanations =
    "All solvers run in this process, warmed up, in turns: each advances its own\n"
    "rollout by one frame, then the next solver does, so that all meet the same\n"
    "machine. Then each makes one step from every state of the reference, in turns.\n"
    "\n"
    "  ms_median, ms_p95,   time of a frame of the rollout\n"
    "  ms_longest\n"
    "  ms_ratio             median over the frames of the time divided by that of\n"
    "                       --relative-to in the same frame\n"
    "  gap_median           energy above the minimum after one step; 1: no better than\n"
    "                       the guess that all start from\n"
    "  progress_median      the same; 1: no better than not moving\n"
    "  rmse_mm              distance to the reference after one step\n"
    "  rollout_rmse_mm      to the reference with the same steps, over the whole rollout\n"
    "  fine_rmse_mm         to the reference of 1/240 s, over the whole rollout\n"
    "  peak_memory_mb       highest resident memory while the solver was made and stepped\n"
    "                       twice, less that before; freed memory was given back first.\n"
    "                       Libraries, and factors that solvers of equal garments share, count\n"
    "                       for the solver that had them first\n"
    "\n"
    "References are kept in DIR/parts for this commit; delete it after a change of the\n"
    "physics. Results are written after each scene.";

}  // namespace

SpeedErrorOptions parse_speed_error_options(const std::vector<std::string>& arguments) {
    SpeedErrorOptions options;
    CLI::App app("speed_error: time per frame of every solver against its error", "speed_error");
    set_up(app);
    add_choice(app, "--scene", options.scenes, scene_names(), "all",
               "tshirt (4,000 vertices, on motion 01_01; default),\n"
               "sheet (hangs by two corners, swings down from horizontal),\n"
               "sphere (a sheet falls on a moving sphere), or all");
    std::string garment = "tshirt";
    add_garment(app, garment, "instead of the T-shirt of the scene tshirt, which takes its name");
    add_choice(app, "--fabric", options.fabrics, {"soft", "real"}, "both",
               "soft (cotton of 33 N/m; default), real (as measured,\n"
               "5 kN/m), or both");
    add_rate(app, options.rate);
    app.add_flag("--limbs", options.limbs,
                 "limbs of the body that pass through others are told apart, as\n"
                 "in a game. Energies are then of other surfaces: look at times\n"
                 "and distances");
    add_whole_number(app, "--frames", options.frames, 0, 100000,
                     "frames (default 30; 0: as long as the scene lasts)");
    add_whole_number(app, "--vertices", options.vertices, 100, 20000,
                     "of the sheets, 100 to 20000 (default 4000)");
    add_list(app, "--solvers", options.solvers,
             "bullet-KxS (K iterations, S sub-steps per frame), xpbd-N (N\n"
             "sub-steps), quasi-newton-K, newton-K (K iterations),\n"
             "quasi-newton-KsR[-cgN] (R small steps a second),\n"
             "quasi-newton (whole steps), NAME (a network as shipped), reference,\n"
             "NAME+K (K refinement iterations), torch-NAME+K (by LibTorch\n"
             "instead of the engine), bf16-NAME+K (products in bfloat16),\n"
             "skinning, skinning-raw (the garment's own network);\n"
             "-bdf2 at the end: by BDF2; @M: in M ms a step. Default: every family at\n"
             "several settings, with all networks of the weights folder");
    app.add_option("--relative-to", options.relative_to,
                   "solver whose time the others' is divided by, frame by frame\n"
                   "(default quasi-newton-3)")
        ->type_name("NAME");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors (default: the committed ones)")
        ->type_name("DIR");
    add_whole_number(app, "--threads", options.threads, 0, 256,
                     "each bound to a core of its own (0: all cores; default)");
    app.add_option("--out", options.out,
                   "where speed_error.csv, speed_error.json and the plots\n"
                   "SCENE_FABRIC_{gap,progress,rmse,fine_rmse}.svg go")
        ->type_name("DIR");
    app.footer(explanations);
    parse(app, arguments);
    check_garment_name(garment);
    std::replace(options.scenes.begin(), options.scenes.end(), std::string("tshirt"), garment);
    return options;
}

std::vector<std::string> default_solvers(const std::vector<std::string>& networks, bool torch) {
    std::vector<std::string> solvers;
    for (const char* substeps : {"1", "2", "8"})
        for (const char* iterations : {"2", "5", "10", "50"})
            solvers.push_back(std::string("bullet-") + iterations + "x" + substeps);
    for (const char* substeps : {"10", "20", "40", "100"})
        solvers.push_back(std::string("xpbd-") + substeps);
    for (const char* setting : {"-1", "-3", "-10", "", "-30", "-3-bdf2", "-10-bdf2", "-bdf2"})
        solvers.push_back(std::string("quasi-newton") + setting);
    for (const char* setting : {"2s60", "2s120", "3s120", "5s120", "3s120-bdf2"})
        solvers.push_back(std::string("quasi-newton-") + setting);
    for (const char* solver : {"newton-1", "newton-3", "newton-10", "reference"})
        solvers.push_back(solver);
    for (const std::string& network : networks) {
        for (const char* refine : {"+0", "+1", "+3", "+10", "", "+10-bdf2"})
            solvers.push_back(network + refine);
        if (torch) solvers.push_back("torch-" + network + "+0");
    }
    return solvers;
}

}  // namespace cloth
