// compare: the same garment on the same moving body, by several solvers, side by side.
// Every solver runs in a process of its own, so that its memory can be told and its failure harms
// no other; what is done is kept in OUT/parts, so that an interrupted run goes on where it stopped.

#include <omp.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/command_line.h"
#include "demos/compare/film.h"
#include "demos/compare/measure.h"
#include "demos/compare/options.h"
#include "demos/compare/progress.h"
#include "demos/compare/report_html.h"
#include "demos/compare/solver_factory.h"
#include "demos/compare/work_folder.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

extern char** environ;

using namespace cloth;
using nlohmann::json;

namespace {

json read_json(const std::string& path) {
    std::ifstream file(path);
    json document = json::parse(file, nullptr, false);
    if (document.is_discarded())
        throw LoadError(path, "", "is not JSON", "delete it; it is computed again");
    return document;
}

void save(const CompareOptions& options, const std::string& name, const Measurement& measurement) {
    save_trajectory(work_file(options, name + ".traj"), measurement.trajectory);
    write_text_file(work_file(options, name + ".json"), measurement.json.dump(1));
}

/// What one child process does: one of the stages that others need, or one solver.
void run_worker(const CompareOptions& options) {
    const BodyScene scene(scene_settings(options));
    Progress line;
    const ProgressFunction progress = [&line](int done, int all, const std::string& what) {
        line.update(done, all, what);
    };
    if (options.worker == "settle") {
        save_trajectory(work_file(options, "settle.traj"), {settle(scene, progress)});
        return;
    }
    const ClothState start = load_trajectory(work_file(options, "settle.traj")).at(0);
    if (options.worker == "fine") {
        save_trajectory(work_file(options, "fine.traj"),
                        fine_reference(scene, {start}, scene.reference_frames(), progress));
        return;
    }
    const auto make = [&] { return make_solver(options.worker, scene, solver_settings(options)); };
    const Trajectory fine = load_trajectory(work_file(options, "fine.traj"));
    if (options.worker == "reference") {
        save(options, options.worker, measure_reference(scene, start, fine, make, progress));
        return;
    }
    const References references{load_trajectory(work_file(options, "reference.traj")), fine};
    save(options, options.worker,
         measure(options.worker, scene, start, references, make, progress));
}

/// Runs this program again for one stage, unless its result is there.
void run_stage(const CompareOptions& options, const std::string& stage) {
    if (std::filesystem::exists(work_file(options, stage + ".traj")) &&
        (stage == "settle" || stage == "fine" ||
         std::filesystem::exists(work_file(options, stage + ".json"))))
        return;
    std::vector<std::string> arguments = worker_arguments(options, stage);
    arguments.insert(arguments.begin(), "compare");
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    pid_t child = 0;
    std::fflush(stdout);
    if (posix_spawn(&child, "/proc/self/exe", nullptr, nullptr, pointers.data(), environ) != 0)
        throw std::runtime_error("cannot start a process for " + stage);
    int status = 0;
    waitpid(child, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw std::runtime_error("the process for " + stage + " failed; see above");
}

json scene_json(const CompareOptions& options, const BodyScene& scene) {
    return {{"garment", options.garment},
            {"vertices", scene.garment().vertex_count()},
            {"faces", scene.garment().face_count()},
            {"body_faces", scene.body().faces()->rows()},
            {"motion", options.motion},
            {"frames", scene.frames()},
            {"reference_frames", scene.reference_frames()},
            {"time_step", scene.frame_time()},
            {"fabric", options.fabric == "real" ? "cotton, 5 kN/m" : "soft cotton, 33 N/m"}};
}

void compare(const CompareOptions& options) {
    const BodyScene scene(scene_settings(options));
    // A wrong name fails at once, and not after the others have run.
    for (const std::string& solver : options.solvers)
        make_solver(solver, scene, solver_settings(options));
    prepare_work_folder(options);
    for (const char* stage : {"settle", "fine", "reference"}) run_stage(options, stage);
    for (const std::string& solver : options.solvers) run_stage(options, solver);

    const int threads = options.threads == 0 ? omp_get_max_threads() : options.threads;
    json report = {{"provenance", provenance_json(threads)},
                   {"scene", scene_json(options, scene)},
                   {"solvers", json::array()}};
    std::vector<Trajectory> trajectories;
    for (const std::string& solver : options.solvers) {
        report["solvers"].push_back(read_json(work_file(options, solver + ".json")));
        trajectories.push_back(load_trajectory(work_file(options, solver + ".traj")));
    }
    write_text_file(options.out + "/report.json", report.dump(1));
    std::vector<std::string> key_frames;
    if (options.video) {
        std::vector<FilmPanel> panels;
        for (size_t k = 0; k < options.solvers.size(); ++k)
            panels.push_back({options.solvers[k], &report["solvers"][k], &trajectories[k]});
        Progress line;
        key_frames = make_film(
            scene, panels, options.out,
            [&line](int done, int all, const std::string& what) { line.update(done, all, what); });
    }
    ReportPictures pictures;
    pictures.key_frames = key_frames;
    if (options.video) pictures.video = options.out + "/comparison.mp4";
    write_text_file(options.out + "/report.html", report_html(report, pictures));
    std::printf("%s/report.html, %s/report.json\n", options.out.c_str(), options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        remove_temporary_files_at_signals();
        const CompareOptions options = parse_compare_options(arguments);
        if (options.threads > 0) omp_set_num_threads(options.threads);
        options.worker.empty() ? compare(options) : run_worker(options);
    });
}
