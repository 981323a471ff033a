// generalisation: networks on what they were trained on, and on what they were not. See --help.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/generalisation/cases.h"
#include "demos/generalisation/summary.h"
#include "demos/provenance/provenance.h"
#include "demos/speed_error/pinning.h"
#include "demos/speed_error/scene_report.h"
#include "render/replaced_file.h"

using namespace cloth;
using nlohmann::ordered_json;

namespace {

struct Options {
    std::vector<std::string> solvers = {"quasi-newton-10", "small+0",
                                        "small+3",         "medium+0",
                                        "small60+2s60",    "hood_fast_coarse60+0s60"};
    std::string relative_to = "quasi-newton-10";
    std::string weights;
    int frames = 45;
    int threads = 0;
    std::string out = "out/generalisation";
};

Options parse_options(const std::vector<std::string>& arguments) {
    Options options;
    CLI::App app("generalisation: networks on what they were trained on, and on what is new",
                 "generalisation");
    set_up(app);
    add_list(app, "--solvers", options.solvers, "as speed_error takes them");
    app.add_option("--relative-to", options.relative_to,
                   "one of them: solves the same scenes without a network\n"
                   "(default quasi-newton-10)")
        ->type_name("NAME");
    app.add_option("--weights", options.weights,
                   "folder with NAME.safetensors (default: the committed ones)")
        ->type_name("DIR");
    add_whole_number(app, "--frames", options.frames, 1, 100000, "of each scene (default 45)");
    add_whole_number(app, "--threads", options.threads, 0, 256, "0: all cores (default)");
    app.add_option("--out", options.out, "where generalisation.json goes")->type_name("DIR");
    app.footer(
        "Needs the shared data folder: its clips and body shapes. Groups of scenes: all of it\n"
        "was trained on; the motion, the body or the garment is new; everything is new.");
    parse(app, arguments);
    if (std::find(options.solvers.begin(), options.solvers.end(), options.relative_to) ==
        options.solvers.end())
        throw UsageError("--relative-to " + options.relative_to + ": choose one of " +
                         join_list(options.solvers, ", "));
    return options;
}

std::vector<SolverRow> measure_group(const CaseGroup& group, const ContestSettings& contest,
                                     Progress& line) {
    std::vector<SolverRow> rows;
    for (const SceneSettings& scene : group.scenes) {
        const SceneReport report =
            measure_scene(scene, contest, [&](int done, int all, const std::string& what) {
                line.update(
                    done, all,
                    group.name + ": " + scene.motion + ", body " + scene.body + ", " + what);
            });
        rows.insert(rows.end(), report.rows.begin(), report.rows.end());
    }
    return rows;
}

void generalisation(const Options& options) {
    const int threads = static_cast<int>(pin_threads(options.threads).size());
    ContestSettings contest;
    contest.solvers = options.solvers;
    contest.solver = {options.weights, threads, nullptr};
    contest.work = options.out + "/parts/" + build_commit();
    ordered_json document = {{"provenance", provenance_json(threads)},
                             {"relative_to", options.relative_to},
                             {"rows", ordered_json::array()},
                             {"scenes", ordered_json::array()}};
    Progress line;
    for (const CaseGroup& group : generalisation_cases(options.frames)) {
        const std::vector<SolverRow> rows = measure_group(group, contest, line);
        for (const SolverRow& row : rows) {
            document["scenes"].push_back(to_json(row));
            document["scenes"].back()["group"] = group.name;
        }
        for (const GroupSummary& summary : summarise(group.name, rows, options.relative_to))
            document["rows"].push_back(to_json(summary));
        write_text_file(options.out + "/generalisation.json", document.dump(1) + "\n");
    }
    std::printf("%s/generalisation.json\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        generalisation(parse_options(arguments));
    });
}
