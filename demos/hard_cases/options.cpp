#include "demos/hard_cases/options.h"

#include <CLI/CLI.hpp>

#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"
#include "demos/hard_cases/hard_cases.h"

namespace cloth {

std::vector<std::string> default_hard_case_steppers() {
    return {"reference", "quasi-newton", "quasi-newton-10", "quasi-newton-3x4",
            "xpbd-40",   "small",        "small+0",         "bullet-fine"};
}

HardCaseOptions parse_hard_case_options(const std::vector<std::string>& arguments) {
    HardCaseOptions options;
    options.steppers = default_hard_case_steppers();
    bool no_pictures = false, no_limbs = false;
    CLI::App app("hard_cases: scenes on which cloth solvers fail, with every solver", "hard_cases");
    set_up(app);
    app.add_flag("--list", options.list, "name the cases");
    add_list(app, "--cases", options.cases, "only these");
    add_list(app, "--motions", options.motions,
             "a garment on a body through these whole motions instead: names,\n"
             "BVH files or folders of them. Stretch may be 1.1 times that of\n"
             "the reference, if it is named first in --steppers");
    add_garment(app, options.garment, "for --motions (default tshirt_1000)");
    app.add_flag("--no-limbs", no_limbs,
                 "for --motions: the body is one surface, and cloth does not pass\n"
                 "through limbs that are inside other limbs (with limbs, depth is\n"
                 "that inside the others)");
    add_list(app, "--steppers", options.steppers,
             "reference, newton-K, quasi-newton-K, quasi-newton-KsR[-cgN],\n"
             "quasi-newton-KxS, xpbd-N, bullet, bullet-fine, bullet-KxS,\n"
             "or a network NAME[+K]");
    add_number(app, "--frames-scale", options.frames_scale, 1e-3, 1e3,
               "runs S times the frames of each case, 0.001 to 1000 (default 1);\n"
               "the bounds on its end count only if it runs in full")
        ->type_name("S");
    add_whole_number(app, "--starts", options.starts, 1, 1000,
                     "runs each case N times, all but the first from a start in which\n"
                     "free vertices are up to 1e-7 m off: what is held by chance is not\n"
                     "held from all (default 1)");
    app.add_flag("--soak", options.soak, "10,000 frames of the soak cases instead of 300");
    add_whole_number(app, "--threads", options.threads, 0, 256,
                     "of the engine (0: all cores; default)");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors (default: the committed weights)")
        ->type_name("DIR");
    app.add_option("--out", options.out, "where hard_cases.json and the pictures go")
        ->type_name("DIR");
    app.add_flag("--no-pictures", no_pictures,
                 "else one picture per case: a row per solver, its first, middle\n"
                 "and last frame");
    app.add_flag("--films", options.films,
                 "also one film per case, of all frames of cases of at most 1,000");
    app.add_flag("--markdown", options.markdown, "prints a table in Markdown at the end");
    app.add_flag("--resume", options.resume,
                 "keeps what hard_cases.json has; run it again without after a\n"
                 "change of a solver");
    app.footer(
        "held: finite, no free vertex deeper inside than the case's bound (1 mm unless stated),\n"
        "99 % of the edges within the case's bound of stretch, no limb through the cloth, and\n"
        "what else the case states; null: not run, and why.");
    parse(app, arguments);
    options.pictures = !no_pictures;
    options.limbs = !no_limbs;
    if (options.cases.empty() && options.motions.empty())
        for (const HardCase& hard : hard_cases()) options.cases.push_back(hard.name);
    for (const std::string& name : options.cases) hard_case(name);
    check_garment_name(options.garment);
    return options;
}

}  // namespace cloth
