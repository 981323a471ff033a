// hard_cases: scenes on which cloth solvers fail, with every solver. See --help.

#include <omp.h>

#include <cstdio>
#include <numeric>

#include "data/files/make_folder.h"
#include "demos/compare/command_line.h"
#include "demos/compare/input_files.h"
#include "demos/compare/progress.h"
#include "demos/hard_cases/contest.h"
#include "demos/hard_cases/motion_cases.h"
#include "demos/hard_cases/options.h"
#include "demos/hard_cases/report.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

constexpr int soak_frames = 10000, most_film_frames = 1000;

void list_cases() {
    for (const HardCase& hard : hard_cases())
        std::printf("%-20s %s\n", hard.name.c_str(), hard.sentence.c_str());
}

/// Committed weights are told apart by the commit.
std::string inputs_of(const HardContest& contest, const std::string& stepper) {
    const std::string weights = contest.solver.weights.empty()
                                    ? ""
                                    : files_key(solver_files(stepper, contest.solver.weights));
    if (contest.hard->inputs.empty() || weights.empty()) return contest.hard->inputs + weights;
    return contest.hard->inputs + "; " + weights;
}

/// The case with the bound of stretch that the reference's row sets, if there is one.
HardCase bounded(HardCase hard, const HardReport& report, int frames) {
    const HardRow* reference = report.find(hard.name, "reference", frames, 1, hard.inputs);
    if (hard.stretch_of_reference && reference && reference->held)
        hard.bounds.stretch_p99 = *hard.stretch_of_reference * reference->stretch_p99;
    return hard;
}

/// All steppers on one case; those with a row already are left out.
void run_case(const HardCaseOptions& options, const HardContest& contest, HardReport& report,
              Progress& line) {
    std::vector<std::string> left;
    for (const std::string& stepper : contest.steppers)
        if (!report.find(contest.hard->name, stepper, contest.frames, contest.starts,
                         inputs_of(contest, stepper)))
            left.push_back(stepper);
    if (left.empty()) return;
    const HardScene scene(contest.hard->parts(), contest.frames);
    std::vector<HardStrip> strips;
    for (const std::string& stepper : left) {
        const HardCase hard = bounded(*contest.hard, report, contest.frames);
        HardResult result = run_stepper(
            {&hard, contest.frames, {}, contest.solver, contest.drawn, contest.starts}, scene,
            stepper,
            [&](int done, int all, const std::string& what) { line.update(done, all, what); });
        result.row.inputs = inputs_of(contest, stepper);
        report.add(result.row);
        strips.push_back(result.strip);
        std::printf("%s\n", text_line(result.row).c_str());
        std::fflush(stdout);
    }
    const std::string file = options.out + "/" + contest.hard->name;
    if (options.pictures)
        write_png(file + ".png",
                  draw_hard_case(scene, contest.drawn, picture_frames(contest.frames), strips));
    if (options.films && contest.frames <= most_film_frames)
        film_hard_case(file + ".mp4", scene, contest.drawn, strips);
}

void run(const HardCaseOptions& options) {
    if (options.list) return list_cases();
    const SolverSettings solver{options.weights, options.threads, nullptr};
    check_steppers(options.steppers, solver);
    make_folder(options.out);
    const int threads = options.threads == 0 ? omp_get_max_threads() : options.threads;
    HardReport report(options.out + "/hard_cases.json", threads, options.resume);
    Progress line;
    const auto run_one = [&](const HardCase& hard) {
        const int frames =
            scaled_frames(hard, options.frames_scale, options.soak ? soak_frames : 0);
        std::vector<int> drawn = picture_frames(frames);
        if (options.films && frames <= most_film_frames) {
            drawn.resize(static_cast<size_t>(frames));
            std::iota(drawn.begin(), drawn.end(), 0);
        }
        run_case(options, {&hard, frames, options.steppers, solver, drawn, options.starts}, report,
                 line);
    };
    for (const std::string& name : options.cases) run_one(hard_case(name));
    for (const std::string& motion : with_folders_listed(options.motions))
        run_one(motion_case(motion, options.garment, options.limbs));
    for (const HardRow& row : report.rows()) std::printf("%s\n", text_line(row).c_str());
    if (options.markdown) std::printf("\n%s", markdown(report.rows()).c_str());
    std::printf("%s/hard_cases.json\n", options.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        remove_temporary_files_at_signals();
        run(parse_hard_case_options(arguments));
    });
}
