#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "collision/proximity/metrics.h"
#include "demos/compare/lasting_loss.h"
#include "demos/compare/references.h"
#include "demos/compare/step_energies.h"
#include "gnn/stepper.h"

namespace cloth {

/// What a solver's rollout collects, one entry per frame. Errors are NaN where there is no
/// reference.
struct Rollout {
    std::vector<double> ms, proximity, features, solve, contact;  ///< (ms)
    std::vector<double> error, fine_error;                        ///< (mm)
    std::vector<double> penetration;                              ///< deepest point (mm)
    std::vector<double> inside;                                   ///< part of the vertices
    std::vector<double> stretch_p50, stretch_p99, stretch_max;
    std::vector<double> gap, progress;  ///< in the frames gap_frames, from its own states
    std::vector<int> gap_frames;
    std::vector<double> residual;
    std::vector<EnergyTerms> terms;  ///< (J), see record_terms()
    JitterMeter jitter;
    bool finite = true;
    std::optional<int> first_failed_frame;
    std::string failure;
};

/// Lets a solver go on from its own states, frame by frame, and measures what it does.
///
///     RolloutMeter meter(scene, references, start, stepper, proximity);
///     while (meter.frame() < scene.frames() && meter.advance(scene.frame_boundary(meter.frame())))
///         ;
class RolloutMeter {
 public:
    /// Keeps references to everything but `start`.
    /// @param proximity  measures penetration
    RolloutMeter(const ComparisonScene& scene, const References& references, ClothState start,
                 Stepper& stepper, Proximity& proximity);

    /// The next frame. False: its numbers are not finite and there is nothing to go on from.
    bool advance(const Boundary& boundary);

    /// Minimises the last step's energy from the solver's result, which is expensive, and records
    /// how far the solver was from that.
    void score_last_step(StepEnergies& energies, const Boundary& boundary);

    /// Records the last step's energy by term at the solver's result. Gravity's, which depends on
    /// the origin, counts from the height of the garment at `level` (|V| x 3, m).
    void record_terms(StepEnergies& energies, const Boundary& boundary, const Points& level);

    int frame() const { return static_cast<int>(m_rollout.ms.size()); }  ///< the next one
    const ClothState& state() const { return m_state; }
    const Rollout& rollout() const { return m_rollout; }

 private:
    void record_times(const StepReport& report, double ms);
    void record_errors(size_t frame);
    void record_shape(const Boundary& boundary, int frame);
    void fail(int frame, const std::string& how);

    const ComparisonScene& m_scene;
    const References& m_references;
    Stepper& m_stepper;
    Proximity& m_proximity;
    ClothState m_before, m_state;
    LastingLoss m_loss;
    Rollout m_rollout;
};

/// The entry `rollout` of a report.
nlohmann::json to_json(const Rollout& rollout);
/// The entry `series`: the values frame by frame.
nlohmann::json series_json(const Rollout& rollout);

}  // namespace cloth
