#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/compare/comparison_scene.h"
#include "demos/compare/trajectory.h"
#include "gnn/stepper.h"

namespace cloth {

/// The trajectories that errors are measured against.
struct References {
    Trajectory coarse;  ///< converged at the frame's time step: states 0 .. reference_frames
    Trajectory fine;    ///< the same energy converged at 1/240 s, at the same times
};

/// Called after each step of a long computation: done, of all, what.
using ProgressFunction = std::function<void(int, int, const std::string&)>;

/// The state in which all solvers start: the garment settled on the body during the lead-in.
ClothState settle(const ComparisonScene& scene, const ProgressFunction& progress);

/// The fine reference: eight converged steps of 1/240 s per frame.
Trajectory fine_reference(const ComparisonScene& scene, const ClothState& start,
                          const ProgressFunction& progress);

/// One solver's figures (an entry of report.json's `solvers`), per-frame series included under
/// "series", and its trajectory.
struct Measurement {
    nlohmann::json json;
    Trajectory trajectory;
};

/// @param make  makes the solver; memory is counted from before this call
Measurement measure(const std::string& name, const ComparisonScene& scene, const ClothState& start,
                    const References& references,
                    const std::function<std::unique_ptr<Stepper>()>& make,
                    const ProgressFunction& progress);

/// The same for the solver that is the reference at the frame's time step. Its trajectory ends
/// after reference_frames; single steps from its own states are its own next states.
Measurement measure_reference(const ComparisonScene& scene, const ClothState& start,
                              const Trajectory& fine,
                              const std::function<std::unique_ptr<Stepper>()>& make,
                              const ProgressFunction& progress);

}  // namespace cloth
