#include "demos/compare/measure.h"

#include <chrono>
#include <cmath>
#include <limits>

#include "collision/metrics.h"
#include "demos/compare/memory.h"
#include "demos/compare/statistics.h"
#include "demos/compare/step_energies.h"

namespace cloth {
namespace {

using nlohmann::json;

constexpr int gap_stride = 10;  // frames between two minimisations from a rollout's own states

/// JSON knows no NaN or infinity: they become null.
json number(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

json numbers(const std::vector<double>& values) {
    json list = json::array();
    for (double value : values) list.push_back(number(value));
    return list;
}

json to_json(const EnergyTerms& terms) {
    return {{"strain", number(terms.strain)},   {"bending", number(terms.bending)},
            {"gravity", number(terms.gravity)}, {"inertia", number(terms.inertia)},
            {"contact", number(terms.contact)}, {"friction", number(terms.friction)}};
}

EnergyTerms mean_terms(const std::vector<EnergyTerms>& all) {
    EnergyTerms mean;
    const double weight = 1.0 / static_cast<double>(all.size());
    for (const EnergyTerms& terms : all) {
        mean.strain += weight * terms.strain;
        mean.bending += weight * terms.bending;
        mean.gravity += weight * terms.gravity;
        mean.inertia += weight * terms.inertia;
        mean.contact += weight * terms.contact;
        mean.friction += weight * terms.friction;
    }
    return mean;
}

Boundary frame_boundary(const ComparisonScene& scene, int frame) {
    const double dt = ComparisonScene::frame_time;
    return scene.boundary(frame * dt, (frame + 1) * dt);
}

/// What a solver makes of one frame that starts in the reference's state.
using SingleStep = std::function<Points(size_t frame, const Boundary&)>;

/// Single steps from the reference's states.
json one_step(const ComparisonScene& scene, const References& references, const SingleStep& step,
              const std::function<void(int)>& done) {
    StepEnergies energies(scene.garment());
    std::vector<double> gap, progress, rmse;
    std::vector<EnergyTerms> terms;
    for (size_t frame = 0; frame + 1 < references.coarse.size(); ++frame) {
        const ClothState& before = references.coarse[frame];
        const ClothState& converged = references.coarse[frame + 1];
        const Boundary boundary = frame_boundary(scene, static_cast<int>(frame));
        const Points x = step(frame, boundary);
        energies.begin(before, boundary, ComparisonScene::frame_time);
        const double minimum = energies.potential().value(converged.x);
        const double energy = energies.potential().value(x);
        gap.push_back(energies.gap(energy, minimum));
        progress.push_back(energies.progress(energy, minimum));
        rmse.push_back(rmse_mm(x, converged.x));
        terms.push_back(energies.potential().terms(x));
        done(static_cast<int>(frame) + 1);
    }
    if (gap.empty()) return nullptr;
    return {{"frames", gap.size()},
            {"gap", {{"median", number(median(gap))}, {"p95", number(quantile(gap, 0.95))}}},
            {"progress", {{"median", number(median(progress))}}},
            {"rmse_mm", number(mean(rmse))},
            {"energy_terms", to_json(mean_terms(terms))},
            {"gap_per_frame", numbers(gap)}};
}

/// What a rollout from the settled state collects frame by frame.
struct Rollout {
    std::vector<double> ms, proximity, features, solve, contact;
    std::vector<double> error, fine_error, penetration, inside;
    JitterMeter jitter;
    std::vector<double> stretch_p50, stretch_p99, stretch_max;
    std::vector<double> gap, progress, residual;
    std::vector<int> gap_frames;
    bool finite = true;
    int first_failed_frame = -1;
    std::string failure;
};

void fail(Rollout& rollout, int frame, const std::string& how) {
    if (rollout.first_failed_frame >= 0) return;
    rollout.first_failed_frame = frame;
    rollout.failure = how;
}

void record_times(const StepReport& report, double ms, Rollout& rollout) {
    rollout.ms.push_back(ms);
    rollout.proximity.push_back(report.times.proximity);
    rollout.features.push_back(report.times.features);
    rollout.solve.push_back(report.times.solve);
    rollout.contact.push_back(report.times.contact);
    rollout.residual.push_back(report.residual);
}

void record_errors(const References& references, size_t frame, const Points& x, Rollout& rollout) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto error_to = [&](const Trajectory& truth) {
        return frame + 1 < truth.size() ? rmse_mm(x, truth[frame + 1].x) : none;
    };
    rollout.error.push_back(error_to(references.coarse));
    rollout.fine_error.push_back(error_to(references.fine));
}

void record_shape(const ComparisonScene& scene, const Boundary& boundary, const Points& x,
                  Proximity& proximity, int frame, Rollout& rollout) {
    const PenetrationStatistics penetration =
        measure_penetration(proximity, boundary, scene.garment(), x);
    rollout.penetration.push_back(1e3 * penetration.max_depth);
    rollout.inside.push_back(penetration.fraction_inside);
    const StretchStatistics stretch = measure_stretch(scene.garment(), x);
    rollout.stretch_p50.push_back(stretch.p50);
    rollout.stretch_p99.push_back(stretch.p99);
    rollout.stretch_max.push_back(stretch.max);
    rollout.jitter.add(x);
    if (stretch.p99 > 2.0) fail(rollout, frame, "torn: 1 % of the edges are stretched beyond 2");
    if (penetration.fraction_inside > 0.2) fail(rollout, frame, "a fifth of the garment is inside");
    const double height = x.col(1).mean() - scene.garment().rest().vertices.col(1).mean();
    const double body_height =
        boundary.obstacles.empty()
            ? height
            : boundary.obstacles[0].x1.col(1).mean() - scene.body().body().rest().col(1).mean();
    if (std::abs(height - body_height) > 0.4) fail(rollout, frame, "slid off the body");
}

void record_gap(StepEnergies& energies, const ClothState& before, const Boundary& boundary,
                const Points& x, int frame, Rollout& rollout) {
    energies.begin(before, boundary, ComparisonScene::frame_time);
    const double minimum = energies.minimum_from(x);
    const double energy = energies.potential().value(x);
    rollout.gap.push_back(energies.gap(energy, minimum));
    rollout.progress.push_back(energies.progress(energy, minimum));
    rollout.gap_frames.push_back(frame);
}

double milliseconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

Rollout roll_out(const ComparisonScene& scene, const ClothState& start, int frames,
                 const References& references, Stepper& stepper, Trajectory& trajectory,
                 const std::function<void(int)>& done) {
    Rollout rollout;
    StepEnergies energies(scene.garment());
    Proximity proximity;
    trajectory = {start};
    for (int frame = 0; frame < frames; ++frame) {
        const Boundary boundary = frame_boundary(scene, frame);
        ClothState state = trajectory.back();
        StepReport report;
        const double ms = milliseconds_of(
            [&] { report = stepper.step(boundary, ComparisonScene::frame_time, state); });
        trajectory.push_back(state);
        record_times(report, ms, rollout);
        if (!report.finite || !state.x.allFinite()) {
            rollout.finite = false;
            fail(rollout, frame, "not finite");
            break;
        }
        const size_t index = static_cast<size_t>(frame);
        record_errors(references, index, state.x, rollout);
        record_shape(scene, boundary, state.x, proximity, frame, rollout);
        if (frame % gap_stride == gap_stride / 2 && frame < scene.reference_frames())
            record_gap(energies, trajectory[index], boundary, state.x, frame, rollout);
        done(frame + 1);
    }
    return rollout;
}

double highest(const std::vector<double>& values) {
    return quantile(values, 1.0);
}

/// Mean over the frames that have a reference.
double mean_error(const std::vector<double>& errors) {
    std::vector<double> known;
    for (double error : errors)
        if (!std::isnan(error)) known.push_back(error);
    return mean(known);
}

json to_json(const Rollout& rollout) {
    return {
        {"frames", rollout.ms.size()},
        {"gap",
         {{"median", number(median(rollout.gap))}, {"p95", number(quantile(rollout.gap, 0.95))}}},
        {"progress", {{"median", number(median(rollout.progress))}}},
        {"rmse_mm", number(mean_error(rollout.error))},
        {"fine_rmse_mm", number(mean_error(rollout.fine_error))},
        {"residual", {{"median", number(median(rollout.residual))}}},
        {"penetration",
         {{"max_mm", number(highest(rollout.penetration))},
          {"fraction", number(mean(rollout.inside))}}},
        {"stretch",
         {{"p50", number(median(rollout.stretch_p50))},
          {"p99", number(median(rollout.stretch_p99))},
          {"max", number(highest(rollout.stretch_max))}}},
        {"jitter_mm", number(1e3 * rollout.jitter.mean())}};
}

json series(const Rollout& rollout) {
    return {{"ms", numbers(rollout.ms)},
            {"rmse_mm", numbers(rollout.error)},
            {"fine_rmse_mm", numbers(rollout.fine_error)},
            {"penetration_mm", numbers(rollout.penetration)},
            {"stretch_p99", numbers(rollout.stretch_p99)},
            {"gap_frames", rollout.gap_frames},
            {"gap", numbers(rollout.gap)}};
}

/// Two steps: first steps allocate and fill caches, which is not what a frame costs.
void warm_up(const ComparisonScene& scene, const ClothState& start, Stepper& stepper) {
    for (int k = 0; k < 2; ++k) {
        ClothState copy = start;
        stepper.step(frame_boundary(scene, 0), ComparisonScene::frame_time, copy);
    }
}

json solver_json(const std::string& name, const Stepper& stepper, double memory,
                 const Rollout& rollout, const json& single) {
    const bool failed = rollout.first_failed_frame >= 0;
    return {{"name", name},
            {"stepper", stepper.name()},
            {"ms_per_frame",
             {{"median", number(median(rollout.ms))}, {"p95", number(quantile(rollout.ms, 0.95))}}},
            {"stages_ms",
             {{"proximity", number(median(rollout.proximity))},
              {"features", number(median(rollout.features))},
              {"solve", number(median(rollout.solve))},
              {"contact", number(median(rollout.contact))}}},
            {"peak_memory_mb", number(memory)},
            {"finite", rollout.finite},
            {"first_failed_frame", failed ? json(rollout.first_failed_frame) : json(nullptr)},
            {"failure", failed ? json(rollout.failure) : json(nullptr)},
            {"one_step", single},
            {"rollout", to_json(rollout)},
            {"series", series(rollout)}};
}

}  // namespace

Measurement measure(const std::string& name, const ComparisonScene& scene, const ClothState& start,
                    const References& references,
                    const std::function<std::unique_ptr<Stepper>()>& make,
                    const ProgressFunction& progress) {
    const double memory_before = resident_memory_mb();
    reset_peak_memory();
    const std::unique_ptr<Stepper> stepper = make();
    warm_up(scene, start, *stepper);
    const double memory = peak_memory_mb() - memory_before;
    Measurement result;
    const Rollout rollout =
        roll_out(scene, start, scene.frames(), references, *stepper, result.trajectory,
                 [&](int done) { progress(done, scene.frames(), name + ", rollout"); });
    const auto step = [&](size_t frame, const Boundary& boundary) {
        ClothState state = references.coarse[frame];
        stepper->step(boundary, ComparisonScene::frame_time, state);
        return state.x;
    };
    const json single = one_step(scene, references, step, [&](int done) {
        progress(done, static_cast<int>(references.coarse.size()) - 1, name + ", single steps");
    });
    result.json = solver_json(name, *stepper, memory, rollout, single);
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
    const json single = one_step(scene, references, step, [](int) {});
    result.json = solver_json("reference", *stepper, memory, rollout, single);
    return result;
}

}  // namespace cloth
