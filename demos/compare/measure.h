#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "demos/compare/references.h"
#include "gnn/stepper.h"

namespace cloth {

/// One solver's figures (an entry of report.json's `solvers`), per-frame series included under
/// "series", and its trajectory.
struct Measurement {
    nlohmann::json json;
    Trajectory trajectory;
};

/// A solver, ready to be timed, and what it took to get there.
struct WarmStepper {
    std::unique_ptr<Stepper> stepper;
    double memory_mb = 0.0;
    double setup_ms = 0.0;  ///< until its first step was done
};

/// Makes a solver and lets it step twice: first steps allocate and fill caches, which is not what a
/// frame costs. The memory is the highest resident memory of this process meanwhile, less that
/// before.
WarmStepper make_warm(const ComparisonScene& scene, const ClothState& start,
                      const std::function<std::unique_ptr<Stepper>()>& make);

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
