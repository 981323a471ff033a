#include "demos/speed_error/contest.h"

#include <limits>

namespace cloth {

std::vector<Rollout> roll_out(const ComparisonScene& scene, const ClothState& start,
                              const References& references,
                              const std::vector<Contestant>& contestants,
                              const ProgressFunction& progress) {
    Proximity proximity;
    std::vector<RolloutMeter> meters;
    for (const Contestant& contestant : contestants)
        meters.emplace_back(scene, references, start, *contestant.warm.stepper, proximity);
    for (int frame = 0; frame < scene.frames(); ++frame) {
        const Boundary boundary = scene.frame_boundary(frame);
        for (RolloutMeter& meter : meters)
            if (meter.rollout().finite) meter.advance(boundary);
        progress(frame + 1, scene.frames(), "rollouts in turn");
    }
    std::vector<Rollout> rollouts;
    for (const RolloutMeter& meter : meters) rollouts.push_back(meter.rollout());
    return rollouts;
}

static Points single_step(const ClothState& before, const Boundary& boundary, double dt,
                          Stepper& stepper) {
    ClothState state = before;
    const StepReport report = stepper.step(boundary, dt, state);
    if (!report.finite) state.x.setConstant(std::numeric_limits<double>::quiet_NaN());
    return state.x;
}

std::vector<SingleSteps> make_single_steps(const ComparisonScene& scene,
                                           const References& references,
                                           const std::vector<Contestant>& contestants,
                                           const ProgressFunction& progress) {
    StepEnergies energies(scene.garment());
    std::vector<SingleSteps> steps(contestants.size());
    for (int frame = 0; frame < scene.reference_frames(); ++frame) {
        const Boundary boundary = scene.frame_boundary(frame);
        const ClothState& before = references.coarse[static_cast<size_t>(frame)];
        const Points& converged = references.coarse[static_cast<size_t>(frame) + 1].x;
        energies.begin(before, boundary, scene.frame_time());
        for (size_t k = 0; k < contestants.size(); ++k)
            steps[k].score(
                energies,
                single_step(before, boundary, scene.frame_time(), *contestants[k].warm.stepper),
                converged);
        progress(frame + 1, scene.reference_frames(), "single steps in turn");
    }
    return steps;
}

std::vector<ContestResult> run_contest(const ComparisonScene& scene, const ClothState& start,
                                       const References& references,
                                       const std::vector<Contestant>& contestants,
                                       const ProgressFunction& progress) {
    const std::vector<Rollout> rollouts = roll_out(scene, start, references, contestants, progress);
    const std::vector<SingleSteps> steps =
        make_single_steps(scene, references, contestants, progress);
    std::vector<ContestResult> results;
    for (size_t k = 0; k < contestants.size(); ++k) results.push_back({rollouts[k], steps[k]});
    return results;
}

}  // namespace cloth
