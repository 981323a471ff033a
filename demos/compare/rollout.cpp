#include "demos/compare/rollout.h"

#include <chrono>
#include <limits>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"

namespace cloth {

using nlohmann::json;

RolloutMeter::RolloutMeter(const ComparisonScene& scene, const References& references,
                           ClothState start, Stepper& stepper, Proximity& proximity)
    : m_scene(scene),
      m_references(references),
      m_stepper(stepper),
      m_proximity(proximity),
      m_state(std::move(start)) {
}

bool RolloutMeter::advance(const Boundary& boundary) {
    const int index = frame();
    m_before = m_state;
    const auto start = std::chrono::steady_clock::now();
    const StepReport report = m_stepper.step(boundary, m_scene.frame_time(), m_state);
    const auto time = std::chrono::steady_clock::now() - start;
    record_times(report, std::chrono::duration<double, std::milli>(time).count());
    if (!report.finite || !m_state.x.allFinite()) {
        m_rollout.finite = false;
        fail(index, "not finite");
        return false;
    }
    record_errors(static_cast<size_t>(index));
    record_shape(boundary, index);
    return true;
}

void RolloutMeter::score_last_step(StepEnergies& energies, const Boundary& boundary) {
    energies.begin(m_before, boundary, m_scene.frame_time());
    const double minimum = energies.minimum_from(m_state.x);
    const double energy = energies.potential().value(m_state.x);
    m_rollout.gap.push_back(energies.gap(energy, minimum));
    m_rollout.progress.push_back(energies.progress(energy, minimum));
    m_rollout.gap_frames.push_back(frame() - 1);
}

void RolloutMeter::record_terms(StepEnergies& energies, const Boundary& boundary,
                                const Points& level) {
    energies.begin(m_before, boundary, m_scene.frame_time());
    EnergyTerms terms = energies.potential().terms(m_state.x);
    terms.gravity -= energies.potential().terms(level).gravity;
    m_rollout.terms.push_back(terms);
}

void RolloutMeter::fail(int frame, const std::string& how) {
    if (m_rollout.first_failed_frame) return;
    m_rollout.first_failed_frame = frame;
    m_rollout.failure = how;
}

void RolloutMeter::record_times(const StepReport& report, double ms) {
    m_rollout.ms.push_back(ms);
    m_rollout.proximity.push_back(report.times.proximity);
    m_rollout.features.push_back(report.times.features);
    m_rollout.solve.push_back(report.times.solve);
    m_rollout.contact.push_back(report.times.contact);
    m_rollout.residual.push_back(
        report.residual.value_or(std::numeric_limits<double>::quiet_NaN()));
}

void RolloutMeter::record_errors(size_t frame) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto error_to = [&](const Trajectory& truth) {
        return frame + 1 < truth.size() ? rmse_mm(m_state.x, truth[frame + 1].x) : none;
    };
    m_rollout.error.push_back(error_to(m_references.coarse));
    m_rollout.fine_error.push_back(error_to(m_references.fine));
}

void RolloutMeter::record_shape(const Boundary& boundary, int frame) {
    const Points& x = m_state.x;
    const PenetrationStatistics penetration =
        measure_penetration(m_proximity, boundary, m_scene.garment(), x);
    m_rollout.penetration.push_back(1e3 * penetration.max_depth);
    m_rollout.inside.push_back(penetration.fraction_inside);
    const StretchStatistics stretch = measure_stretch(m_scene.garment(), x);
    m_rollout.stretch_p50.push_back(stretch.p50);
    m_rollout.stretch_p99.push_back(stretch.p99);
    m_rollout.stretch_max.push_back(stretch.max);
    m_rollout.jitter.add(x);
    if (stretch.p99 > 2.0) fail(frame, "torn: 1 % of the edges are stretched beyond 2");
    if (penetration.fraction_inside > 0.2) fail(frame, "a fifth of the garment is inside");
    const std::string loss = m_scene.loss(boundary, x);
    const bool is_last = frame + 1 == m_scene.frames();
    if (const auto since = m_loss.add(frame, !loss.empty(), is_last, m_scene.frame_time()))
        fail(*since, loss);
}

static double highest(const std::vector<double>& values) {
    return quantile(values, 1.0);
}

json to_json(const Rollout& rollout) {
    return {{"frames", rollout.ms.size()},
            {"gap",
             {{"median", json_number(median(rollout.gap))},
              {"p95", json_number(quantile(rollout.gap, 0.95))}}},
            {"progress", {{"median", json_number(median(rollout.progress))}}},
            {"rmse_mm", json_number(mean_of_known(rollout.error))},
            {"fine_rmse_mm", json_number(mean_of_known(rollout.fine_error))},
            {"residual", {{"median", json_number(median(rollout.residual))}}},
            {"penetration",
             {{"max_mm", json_number(highest(rollout.penetration))},
              {"fraction", json_number(mean(rollout.inside))}}},
            {"stretch",
             {{"p50", json_number(median(rollout.stretch_p50))},
              {"p99", json_number(median(rollout.stretch_p99))},
              {"max", json_number(highest(rollout.stretch_max))}}},
            {"jitter_mm", json_number(1e3 * rollout.jitter.mean())}};
}

json series_json(const Rollout& rollout) {
    return {{"ms", json_numbers(rollout.ms)},
            {"rmse_mm", json_numbers(rollout.error)},
            {"fine_rmse_mm", json_numbers(rollout.fine_error)},
            {"penetration_mm", json_numbers(rollout.penetration)},
            {"stretch_p99", json_numbers(rollout.stretch_p99)},
            {"gap_frames", rollout.gap_frames},
            {"gap", json_numbers(rollout.gap)}};
}

}  // namespace cloth
