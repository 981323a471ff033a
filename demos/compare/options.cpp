#include "demos/compare/options.h"

#include <map>

namespace cloth {
BodySceneSettings scene_settings(const CompareOptions& options) {
    BodySceneSettings scene;
    scene.garment = options.garment;
    scene.fabric = options.fabric;
    scene.motion = options.motion;
    scene.frames = options.frames;
    scene.reference_frames = options.reference_frames;
    return scene;
}

SolverSettings solver_settings(const CompareOptions& options) {
    return {options.weights, options.threads, nullptr};
}

std::string compare_usage() {
    return "compare: solvers of the same cloth on the same moving body, side by side\n"
           "  --garment NAME         tshirt (4,000 vertices), tshirt_2000, tshirt_1000\n"
           "  --motion NAME          01_01, 01_03, Boxing_Toes, a clip's number or a BVH file\n"
           "  --fabric soft|real     soft cotton of 33 N/m, or cotton as measured, 5 kN/m\n"
           "  --solvers A,B,...      bullet, bullet-fine, bullet-K (K iterations), reference,\n"
           "                         quasi-newton, quasi-newton-K (K iterations), xpbd-N (N\n"
           "                         substeps), and networks: small, fast, baseline, sampling,\n"
           "                         reduction, as shipped (10 refinement iterations or more,\n"
           "                         fast motion in sub-steps), or each with +K for exactly K\n"
           "                         refinement iterations (+0: the network alone); -bdf2 at\n"
           "                         the end: by BDF2 instead of backward Euler;\n"
           "                         bf16-NAME: its products in bfloat16\n"
           "  --frames N             frames of 1/30 s of the motion (default 90; 0: all)\n"
           "  --reference-frames N   frames with references and one-step errors (default 30; 0: "
           "all)\n"
           "  --weights DIR          folder with NAME.safetensors (default: the committed "
           "weights)\n"
           "  --threads N            0: all cores\n"
           "  --no-video             tables and plots only\n"
           "  --out DIR              where comparison.mp4, report.json and report.html go\n"
           "A run that was interrupted goes on where it stopped; delete DIR/work to start "
           "afresh.\n";
}

CompareOptions parse_compare_options(const std::vector<std::string>& arguments) {
    CompareOptions options;
    options.solvers = {"bullet",       "bullet-fine", "quasi-newton-10", "quasi-newton-10-bdf2",
                       "quasi-newton", "xpbd-40",     "small",           "small+0"};
    std::map<std::string, std::string*> texts = {
        {"--garment", &options.garment}, {"--motion", &options.motion},
        {"--fabric", &options.fabric},   {"--weights", &options.weights},
        {"--out", &options.out},         {"--worker", &options.worker}};
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        if (option == "--help" || option == "-h") throw UsageError(compare_usage());
        if (option == "--no-video") {
            options.video = false;
            continue;
        }
        if (i + 1 == arguments.size()) throw UsageError(option + " needs a value; see --help");
        const std::string& value = arguments[++i];
        if (texts.count(option))
            *texts[option] = value;
        else if (option == "--solvers")
            options.solvers = split_list(value);
        else if (option == "--frames")
            options.frames = whole_number(option, value, 0, 100000);
        else if (option == "--reference-frames")
            options.reference_frames = whole_number(option, value, 0, 100000);
        else if (option == "--threads")
            options.threads = whole_number(option, value, 0, 256);
        else
            throw UsageError("unknown option " + option + "; see --help");
    }
    if (options.fabric != "soft" && options.fabric != "real")
        throw UsageError("--fabric " + options.fabric + ": choose soft or real");
    if (options.solvers.empty()) throw UsageError("--solvers: name at least one; see --help");
    return options;
}

std::vector<std::string> worker_arguments(const CompareOptions& options,
                                          const std::string& worker) {
    std::vector<std::string> arguments = {"--garment",
                                          options.garment,
                                          "--motion",
                                          options.motion,
                                          "--fabric",
                                          options.fabric,
                                          "--out",
                                          options.out,
                                          "--solvers",
                                          join_list(options.solvers),
                                          "--frames",
                                          std::to_string(options.frames),
                                          "--reference-frames",
                                          std::to_string(options.reference_frames),
                                          "--threads",
                                          std::to_string(options.threads),
                                          "--worker",
                                          worker};
    if (!options.weights.empty()) arguments.insert(arguments.end(), {"--weights", options.weights});
    return arguments;
}

}  // namespace cloth
