#include "demos/compare/options.h"

#include <CLI/CLI.hpp>

#include "demos/compare/body_named.h"
#include "demos/compare/command_line.h"

namespace cloth {

BodySceneSettings scene_settings(const CompareOptions& options) {
    BodySceneSettings scene;
    scene.garment = options.garment;
    scene.body = options.body;
    scene.fabric = options.fabric;
    scene.motion = options.motion;
    scene.rate = options.rate;
    scene.frames = options.frames;
    scene.reference_frames = options.reference_frames;
    return scene;
}

SolverSettings solver_settings(const CompareOptions& options) {
    return {options.weights, options.threads, nullptr};
}

CompareOptions parse_compare_options(const std::vector<std::string>& arguments) {
    CompareOptions options;
    options.solvers = {"bullet",       "bullet-fine", "quasi-newton-10", "quasi-newton-10-bdf2",
                       "quasi-newton", "xpbd-40",     "small",           "small+0"};
    bool no_video = false;
    CLI::App app("compare: solvers of the same cloth on the same moving body, side by side",
                 "compare");
    set_up(app);
    add_garment(app, options.garment, "what the body wears (default tshirt)");
    add_body(app, options.body);
    app.add_option("--motion", options.motion,
                   "01_01, 01_03, Boxing_Toes, a clip's number or a BVH file")
        ->type_name("NAME");
    app.add_option("--fabric", options.fabric,
                   "soft cotton of 33 N/m, or cotton as measured, 5 kN/m")
        ->check(CLI::IsMember({"soft", "real"}).description(""))
        ->type_name("soft|real");
    add_list(app, "--solvers", options.solvers,
             "default (the library's), bullet, bullet-fine, bullet-K, bullet-KxS\n"
             "(K iterations, S sub-steps), reference, newton-K,\n"
             "quasi-newton, quasi-newton-K (K iterations), quasi-newton-KxS,\n"
             "quasi-newton-KsR[-cgN] (R small steps a second), xpbd-N (N\n"
             "substeps), skinning, skinning-raw (the garment's own\n"
             "network, if it has one), and networks: small, fast, baseline, sampling,\n"
             "reduction, as shipped (10 refinement iterations or more,\n"
             "fast motion in sub-steps), or each with +K for exactly K\n"
             "refinement iterations (+0: the network alone), +KsR for small\n"
             "steps; -bdf2 at the end: by BDF2 instead of backward Euler;\n"
             "bf16-NAME: its products in bfloat16; @M at the end: in M ms\n"
             "a step, see Stepper::set_max_ms(); ~N or ~GARMENT: on a proxy of\n"
             "N vertices or another garment, which shows this one, and +K,\n"
             "+NAME or +NAME+K behind that: with a step of its own.\n"
             "Default: bullet,bullet-fine,quasi-newton-10,\n"
             "quasi-newton-10-bdf2,quasi-newton,xpbd-40,small,small+0");
    add_hint(app, "--character",
             "bake, viewer and hello_character take one; solvers are compared on the project's "
             "body");
    add_rate(app, options.rate);
    add_whole_number(app, "--frames", options.frames, 0, 100000,
                     "frames of the motion (default 90; 0: all)");
    add_whole_number(app, "--reference-frames", options.reference_frames, 0, 100000,
                     "frames with references and one-step errors (default 30; 0: all)");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors (default: the committed weights)")
        ->type_name("DIR");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores");
    app.add_flag("--no-video", no_video, "tables and plots only");
    app.add_option("--out", options.out, "where comparison.mp4, report.json and report.html go")
        ->type_name("DIR");
    app.add_option("--worker", options.worker)->group("");  // not in the help
    app.footer(
        "A run that was interrupted goes on where it stopped; delete DIR/parts to start "
        "afresh.");
    parse(app, arguments);
    check_garment_name(options.garment);
    body_shape_named(options.body);
    options.video = !no_video;
    return options;
}

std::vector<std::string> worker_arguments(const CompareOptions& options,
                                          const std::string& worker) {
    std::vector<std::string> arguments = {"--garment",
                                          options.garment,
                                          "--body",
                                          options.body,
                                          "--motion",
                                          options.motion,
                                          "--fabric",
                                          options.fabric,
                                          "--out",
                                          options.out,
                                          "--solvers",
                                          join_list(options.solvers),
                                          "--rate",
                                          std::to_string(options.rate),
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
