// speed_error: time per frame of every solver against its error, all solvers in turns in one
// process. See --help.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "demos/compare/arguments.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/provenance/provenance.h"
#include "demos/speed_error/options.h"
#include "demos/speed_error/pinning.h"
#include "demos/speed_error/plots.h"
#include "demos/speed_error/scene_report.h"
#include "demos/speed_error/torch_backend.h"
#include "render/replaced_file.h"

using namespace cloth;
using nlohmann::ordered_json;

namespace {

/// Processes that ran or waited to run, on average over the last minute.
double load_average() {
    double load = 0.0;
    return getloadavg(&load, 1) == 1 ? load : 0.0;
}

ordered_json head_json(const std::vector<int>& cores, bool torch, const std::string& relative_to) {
    return {{"provenance", provenance_json(static_cast<int>(cores.size()))},
            {"cores", cores},
            {"libtorch", torch},
            {"relative_to", relative_to.empty() ? ordered_json() : ordered_json(relative_to)},
            {"load_average_before", load_average()}};
}

void write_plots(const SpeedErrorOptions& options, const SceneReport& report) {
    const std::string scene = std::filesystem::path(report.rows.front().scene).stem().string();
    for (const NamedPlot& plot : speed_error_plots(report.rows))
        write_text_file(
            options.out + "/" + scene + "_" + report.rows.front().fabric + "_" + plot.name + ".svg",
            plot.svg);
}

void write_tables(const SpeedErrorOptions& options, const ordered_json& head,
                  const std::vector<SolverRow>& rows) {
    ordered_json document = head;
    document["load_average_after"] = load_average();
    document["rows"] = ordered_json::array();
    for (const SolverRow& row : rows) document["rows"].push_back(to_json(row));
    write_text_file(options.out + "/speed_error.json", document.dump(1) + "\n");
    write_text_file(options.out + "/speed_error.csv", to_csv(rows));
}

/// The solver that times are divided by; empty: none of those that take part.
std::string compared_with(const std::string& wanted, const std::vector<std::string>& solvers) {
    const std::string name = wanted.empty() ? "quasi-newton-3" : wanted;
    if (std::find(solvers.begin(), solvers.end(), name) != solvers.end()) return name;
    if (wanted.empty()) return "";
    throw UsageError("--relative-to " + name + ": choose one of " + join_list(solvers, ", "));
}

void speed_error(const SpeedErrorOptions& options) {
    const std::vector<int> cores = pin_threads(options.threads);
    const int threads = static_cast<int>(cores.size());
    ContestSettings contest;
    contest.solver = {options.weights, threads, torch_backend(threads)};
    const bool torch = contest.solver.torch != nullptr;
    if (!torch) std::printf("built without LibTorch: no rows of it\n");
    contest.solvers = options.solvers;
    if (contest.solvers.empty())
        contest.solvers = default_solvers(networks_in(options.weights), torch);
    contest.relative_to = compared_with(options.relative_to, contest.solvers);
    contest.work = options.out + "/parts/" + build_commit();

    ordered_json head = head_json(cores, torch, contest.relative_to);
    std::vector<SolverRow> rows;
    Progress line;
    for (const std::string& scene : options.scenes)
        for (const std::string& fabric : options.fabrics) {
            SceneSettings settings{scene, fabric, options.frames, options.vertices, options.rate};
            settings.limbs = options.limbs;
            const SceneReport report = measure_scene(
                settings, contest,
                [&](int done, int all, const std::string& what) { line.update(done, all, what); });
            head["scenes"].push_back(report.description);
            rows.insert(rows.end(), report.rows.begin(), report.rows.end());
            write_plots(options, report);
            write_tables(options, head, rows);
        }
    std::printf("%s/speed_error.csv, .json and plots\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        speed_error(parse_speed_error_options(arguments));
    });
}
