#include "demos/hard_cases/options.h"

#include <map>

#include "demos/compare/arguments.h"
#include "demos/hard_cases/hard_cases.h"

namespace cloth {

std::string hard_cases_usage() {
    return "hard_cases: scenes on which cloth solvers fail, with every solver\n"
           "  --list               name the cases\n"
           "  --cases A,B,...      only these\n"
           "  --motions A,B,...    a garment on a body through these whole motions instead: "
           "names,\n"
           "                       BVH files or folders of them. Stretch may be 1.1 times that of\n"
           "                       the reference, if it is named first in --steppers\n"
           "  --garment NAME       for --motions: tshirt_1000 (default), tshirt_2000, tshirt\n"
           "  --no-limbs           for --motions: the body is one surface, and cloth does not "
           "pass\n"
           "                       through limbs that are inside other limbs (with limbs, depth "
           "is\n"
           "                       that inside the others)\n"
           "  --steppers A,B,...   reference, newton-K, quasi-newton-K, quasi-newton-KxS, xpbd-N,\n"
           "                       bullet, bullet-fine, bullet-KxS, or a network NAME[+K]\n"
           "  --frames-scale S     runs S times the frames of each case (default 1); the bounds "
           "on\n"
           "                       its end count only if it runs in full\n"
           "  --soak               10,000 frames of the soak cases instead of 300\n"
           "  --threads N          of the engine (0: all cores; default)\n"
           "  --weights DIR        folder with NAME.safetensors (default: the committed weights)\n"
           "  --out DIR            where hard_cases.json and the pictures go\n"
           "  --no-pictures        else one picture per case: a row per solver, its first, middle\n"
           "                       and last frame\n"
           "  --markdown           prints a table in Markdown at the end\n"
           "  --resume             keeps what hard_cases.json has; run it again without after a\n"
           "                       change of a solver\n"
           "\n"
           "held: finite, no free vertex deeper inside than the case's bound (1 mm unless "
           "stated),\n"
           "99 % of the edges within the case's bound of stretch, no limb through the cloth, and\n"
           "what else the case states; null: not run, and why.\n";
}

std::vector<std::string> default_hard_case_steppers() {
    return {"reference", "quasi-newton", "quasi-newton-10", "quasi-newton-3x4",
            "xpbd-40",   "small",        "small+0",         "bullet-fine"};
}

static double positive_number(const std::string& option, const std::string& text) {
    size_t used = 0;
    double value = 0.0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        used = 0;
    }
    if (text.empty() || used != text.size() || !(value >= 1e-3 && value <= 1e3))
        throw UsageError(option + " " + text + ": give a number from 0.001 to 1000");
    return value;
}

HardCaseOptions parse_hard_case_options(const std::vector<std::string>& arguments) {
    HardCaseOptions options;
    options.steppers = default_hard_case_steppers();
    bool no_pictures = false, no_limbs = false;
    const std::map<std::string, bool*> flags = {
        {"--soak", &options.soak},     {"--list", &options.list}, {"--markdown", &options.markdown},
        {"--resume", &options.resume}, {"--no-limbs", &no_limbs}, {"--no-pictures", &no_pictures}};
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        if (option == "--help" || option == "-h") throw UsageError(hard_cases_usage());
        if (const auto flag = flags.find(option); flag != flags.end()) {
            *flag->second = true;
            continue;
        }
        if (i + 1 == arguments.size())
            throw UsageError(option + " is unknown or needs a value; see --help");
        const std::string& value = arguments[++i];
        if (option == "--cases")
            options.cases = split_list(value);
        else if (option == "--motions")
            options.motions = split_list(value);
        else if (option == "--garment")
            options.garment = value;
        else if (option == "--steppers")
            options.steppers = split_list(value);
        else if (option == "--frames-scale")
            options.frames_scale = positive_number(option, value);
        else if (option == "--threads")
            options.threads = whole_number(option, value, 0, 256);
        else if (option == "--weights")
            options.weights = value;
        else if (option == "--out")
            options.out = value;
        else
            throw UsageError("unknown option " + option + "; see --help");
    }
    options.pictures = !no_pictures;
    options.limbs = !no_limbs;
    if (options.cases.empty() && options.motions.empty())
        for (const HardCase& hard : hard_cases()) options.cases.push_back(hard.name);
    for (const std::string& name : options.cases) hard_case(name);
    if (options.steppers.empty()) throw UsageError("--steppers: name at least one; see --help");
    return options;
}

}  // namespace cloth
