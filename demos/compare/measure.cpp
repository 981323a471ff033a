#include "demos/compare/measure.h"

#include <malloc.h>

#include <chrono>
#include <limits>

#include "demos/compare/json_numbers.h"
#include "demos/compare/memory.h"
#include "demos/compare/rollout.h"
#include "demos/compare/single_steps.h"
#include "demos/compare/statistics.h"

namespace cloth {
namespace {

using nlohmann::json;

constexpr int gap_stride = 10;  // frames between two minimisations from a rollout's own states

/// What a solver makes of one frame that starts in the reference's state.
using SingleStep = std::function<Points(size_t frame, const Boundary&)>;

SingleSteps single_steps(const ComparisonScene& scene, const References& references,
                         const SingleStep& step, const std::function<void(int)>& done) {
    StepEnergies energies(scene.garment());
    SingleSteps steps;
    for (size_t frame = 0; frame + 1 < references.coarse.size(); ++frame) {
        const Boundary boundary = scene.frame_boundary(static_cast<int>(frame));
        const Points x = step(frame, boundary);
        energies.begin(references.coarse[frame], boundary, scene.frame_time());
        steps.score(energies, x, references.coarse[frame + 1].x);
        done(static_cast<int>(frame) + 1);
    }
    return steps;
}

Rollout roll_out(const ComparisonScene& scene, const ClothState& start, int frames,
                 const References& references, Stepper& stepper, Trajectory& trajectory,
                 const std::function<void(int)>& done) {
    StepEnergies energies(scene.garment());
    Proximity proximity;
    RolloutMeter meter(scene, references, start, stepper, proximity);
    trajectory = {start};
    for (int frame = 0; frame < frames; ++frame) {
        const Boundary boundary = scene.frame_boundary(frame);
        const bool finite = meter.advance(boundary);
        trajectory.push_back(meter.state());
        if (!finite) break;
        if (frame % gap_stride == gap_stride / 2 && frame < scene.reference_frames())
            meter.score_last_step(energies, boundary);
        done(frame + 1);
    }
    return meter.rollout();
}

json solver_json(const std::string& name, const Stepper& stepper, double memory,
                 const Rollout& rollout, const SingleSteps& single) {
    const bool failed = rollout.first_failed_frame.has_value();
    return {{"name", name},
            {"stepper", stepper.name()},
            {"ms_per_frame",
             {{"median", json_number(median(rollout.ms))},
              {"p95", json_number(quantile(rollout.ms, 0.95))}}},
            {"stages_ms",
             {{"proximity", json_number(median(rollout.proximity))},
              {"features", json_number(median(rollout.features))},
              {"solve", json_number(median(rollout.solve))},
              {"contact", json_number(median(rollout.contact))}}},
            {"peak_memory_mb", json_number(memory)},
            {"finite", rollout.finite},
            {"first_failed_frame", failed ? json(*rollout.first_failed_frame) : json(nullptr)},
            {"failure", failed ? json(rollout.failure) : json(nullptr)},
            {"one_step", to_json(single)},
            {"rollout", to_json(rollout)},
            {"series", series_json(rollout)}};
}

}  // namespace

WarmStepper make_warm(const ComparisonScene& scene, const ClothState& start,
                      const std::function<std::unique_ptr<Stepper>()>& make) {
    malloc_trim(0);
    const double before = resident_memory_mb();
    reset_peak_memory();
    const Boundary boundary = scene.frame_boundary(0);
    const auto begin = std::chrono::steady_clock::now();
    WarmStepper warm;
    warm.stepper = make();
    for (int k = 0; k < 2; ++k) {
        ClothState copy = start;
        warm.stepper->step(boundary, scene.frame_time(), copy);
        const auto time = std::chrono::steady_clock::now() - begin;
        if (k == 0) warm.setup_ms = std::chrono::duration<double, std::milli>(time).count();
    }
    warm.memory_mb = peak_memory_mb() - before;
    return warm;
}

Measurement measure(const std::string& name, const ComparisonScene& scene, const ClothState& start,
                    const References& references,
                    const std::function<std::unique_ptr<Stepper>()>& make,
                    const ProgressFunction& progress) {
    const WarmStepper warm = make_warm(scene, start, make);
    Measurement result;
    const Rollout rollout =
        roll_out(scene, start, scene.frames(), references, *warm.stepper, result.trajectory,
                 [&](int done) { progress(done, scene.frames(), name + ", rollout"); });
    const auto step = [&](size_t frame, const Boundary& boundary) {
        ClothState state = references.coarse[frame];
        const StepReport report = warm.stepper->step(boundary, scene.frame_time(), state);
        if (!report.finite) state.x.setConstant(std::numeric_limits<double>::quiet_NaN());
        return state.x;
    };
    const SingleSteps single = single_steps(scene, references, step, [&](int done) {
        progress(done, static_cast<int>(references.coarse.size()) - 1, name + ", single steps");
    });
    result.json = solver_json(name, *warm.stepper, warm.memory_mb, rollout, single);
    return result;
}

Measurement measure_reference(const ComparisonScene& scene, const ClothState& start,
                              const Trajectory& fine,
                              const std::function<std::unique_ptr<Stepper>()>& make,
                              const ProgressFunction& progress) {
    const double memory_before = resident_memory_mb();
    reset_peak_memory();
    const std::unique_ptr<Stepper> stepper = make();
    Measurement result;
    References references{{}, fine};
    Rollout rollout =
        roll_out(scene, start, scene.reference_frames(), references, *stepper, result.trajectory,
                 [&](int done) { progress(done, scene.reference_frames(), "reference, 1/30 s"); });
    const double memory = peak_memory_mb() - memory_before;
    references.coarse = result.trajectory;
    rollout.error.assign(rollout.error.size(), 0.0);
    const auto step = [&](size_t frame, const Boundary&) { return result.trajectory[frame + 1].x; };
    const SingleSteps single = single_steps(scene, references, step, [](int) {});
    result.json = solver_json("reference", *stepper, memory, rollout, single);
    return result;
}

}  // namespace cloth
