#include "demos/speed_error/options.h"

#include <algorithm>
#include <map>

#include "demos/compare/arguments.h"
#include "demos/speed_error/scenes.h"

namespace cloth {
namespace {

/// The choices that `value` names: one of them, or all.
std::vector<std::string> chosen(const std::string& option, const std::string& value,
                                const std::vector<std::string>& choices, const std::string& all) {
    if (value == all) return choices;
    if (std::find(choices.begin(), choices.end(), value) != choices.end()) return {value};
    throw UsageError(option + " " + value + ": choose " + join_list(choices, ", ") + " or " + all);
}

}  // namespace

std::string speed_error_usage() {
    return "speed_error: time per frame of every solver against its error\n"
           "  --scene NAME         tshirt (4,000 vertices, on motion 01_01; default),\n"
           "                       sheet (hangs by two corners, swings down from horizontal),\n"
           "                       sphere (a sheet falls on a moving sphere), or all\n"
           "  --fabric NAME        soft (cotton of 33 N/m; default), real (as measured,\n"
           "                       5 kN/m), or both\n"
           "  --frames N           frames of 1/30 s (default 30; 0: as long as the scene lasts)\n"
           "  --vertices N         of the sheets, 100 to 20000 (default 4000)\n"
           "  --solvers A,B,...    bullet-KxS (K iterations, S sub-steps per frame), xpbd-N (N\n"
           "                       sub-steps), quasi-newton-K, newton-K (K iterations),\n"
           "                       quasi-newton, NAME (a network; both as shipped), reference,\n"
           "                       NAME+K (K refinement iterations), torch-NAME+K (by LibTorch\n"
           "                       instead of the engine), bf16-NAME+K (products in bfloat16);\n"
           "                       -bdf2 at the end: by BDF2. Default: every family at\n"
           "                       several settings, with all networks of the weights folder\n"
           "  --relative-to NAME   solver whose time the others' is divided by, frame by frame\n"
           "                       (default quasi-newton-3)\n"
           "  --weights DIR        folder with NAME.safetensors (default: the committed ones)\n"
           "  --threads N          each bound to a core of its own (0: all cores; default)\n"
           "  --out DIR            where speed_error.csv, speed_error.json and the plots\n"
           "                       SCENE_FABRIC_{gap,progress,rmse,fine_rmse}.svg go\n"
           "\n"
           "All solvers run in this process, warmed up, in turns: each advances its own\n"
           "rollout by one frame, then the next solver does, so that all meet the same\n"
           "machine. Then each makes one step from every state of the reference, in turns.\n"
           "\n"
           "  ms_median, ms_p95    time of a frame of the rollout\n"
           "  ms_ratio             median over the frames of the time divided by that of\n"
           "                       --relative-to in the same frame\n"
           "  gap_median           energy above the minimum after one step; 1: no better than\n"
           "                       the guess that all start from\n"
           "  progress_median      the same; 1: no better than not moving\n"
           "  rmse_mm              distance to the reference after one step\n"
           "  rollout_rmse_mm      to the reference of 1/30 s, over the whole rollout\n"
           "  fine_rmse_mm         to the reference of 1/240 s, over the whole rollout\n"
           "  peak_memory_mb       highest resident memory while the solver was made and stepped\n"
           "                       twice, less that before; freed memory was given back first.\n"
           "                       Libraries count for the solver that touched them first\n"
           "\n"
           "References are kept in DIR/work for this commit; delete it after a change of the\n"
           "physics. Results are written after each scene.\n";
}

SpeedErrorOptions parse_speed_error_options(const std::vector<std::string>& arguments) {
    SpeedErrorOptions options;
    std::map<std::string, std::string*> texts = {{"--relative-to", &options.relative_to},
                                                 {"--weights", &options.weights},
                                                 {"--out", &options.out}};
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        if (option == "--help" || option == "-h") throw UsageError(speed_error_usage());
        if (i + 1 == arguments.size()) throw UsageError(option + " needs a value; see --help");
        const std::string& value = arguments[++i];
        if (texts.count(option))
            *texts[option] = value;
        else if (option == "--scene")
            options.scenes = chosen(option, value, scene_names(), "all");
        else if (option == "--fabric")
            options.fabrics = chosen(option, value, {"soft", "real"}, "both");
        else if (option == "--solvers")
            options.solvers = split_list(value);
        else if (option == "--frames")
            options.frames = whole_number(option, value, 0, 100000);
        else if (option == "--vertices")
            options.vertices = whole_number(option, value, 100, 20000);
        else if (option == "--threads")
            options.threads = whole_number(option, value, 0, 256);
        else
            throw UsageError("unknown option " + option + "; see --help");
        if (option == "--solvers" && options.solvers.empty())
            throw UsageError("--solvers: name at least one; see --help");
    }
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
