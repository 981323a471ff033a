#include "demos/hard_cases/contest.h"

#include <algorithm>
#include <cmath>

#include "data/core/errors.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr double reference_budget = 350000.0;  // vertices times frames that Newton is run for

bool too_expensive(const std::string& stepper, const HardScene& scene) {
    const auto vertices = static_cast<double>(scene.garment().vertex_count());
    return stepper == "reference" && vertices * scene.frames() > reference_budget;
}

HardResult without_run(HardRow row, int starts) {
    row.starts = starts;
    return {row, {row.stepper + ": " + (row.held ? "refused" : "not run"), {}}};
}

}  // namespace

void check_steppers(const std::vector<std::string>& steppers, const SolverSettings& solver) {
    const HardScene scrap(swing(level_sheet(60), {}), 1);
    for (const std::string& name : steppers) {
        try {
            make_solver(name, scrap, solver);
        } catch (const ArgumentError&) {
            // The name is right, and refuses this scrap: each scene is asked on its own.
        }
    }
}

int scaled_frames(const HardCase& hard, double scale, int soak_frames) {
    const bool soak = hard.name.rfind("soak-", 0) == 0;
    const int frames = soak && soak_frames > 0 ? soak_frames : hard.frames;
    return std::max(1, static_cast<int>(std::lround(scale * frames)));
}

HardResult run_stepper(const HardContest& contest, const HardScene& scene,
                       const std::string& stepper,
                       const std::function<void(int, int, const std::string&)>& progress) {
    const HardCase& hard = *contest.hard;
    if (too_expensive(stepper, scene))
        return without_run(skipped_row(hard, stepper, "too expensive", contest.frames),
                           contest.starts);
    std::unique_ptr<Stepper> solver;
    try {
        solver = make_solver(stepper, scene, contest.solver);
    } catch (const ArgumentError& error) {
        return without_run(refused_row(hard, stepper, error.what(), contest.frames),
                           contest.starts);
    }
    const std::string reason = not_applicable(*solver, scene);
    if (!reason.empty())
        return without_run(skipped_row(hard, stepper, reason, contest.frames), contest.starts);
    const int all = contest.starts * scene.frames();
    const auto run_from = [&](int start, const std::vector<int>& drawn) {
        const int before = start * scene.frames();
        return run_hard_case(
            hard, scene, *solver, drawn,
            [&](int done) { progress(before + done, all, hard.name + ", " + stepper); }, start);
    };
    const HardRun run = run_from(0, contest.drawn);
    HardRow row = make_row(hard, stepper, run, contest.frames);
    row.starts = contest.starts;
    for (int start = 1; start < contest.starts; ++start) {
        solver = make_solver(stepper, scene, contest.solver);
        if (run_from(start, {}).held()) ++row.starts_held;
    }
    const std::string mark = run.held() ? ": held" : ": FAILED";
    return {row, {stepper + mark, run.x}};
}

}  // namespace cloth
