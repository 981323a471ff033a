#pragma once

#include <functional>
#include <string>

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

/// The state in which all solvers start: the garment after the lead-in.
ClothState settle(const ComparisonScene& scene, const ProgressFunction& progress);
/// The same as a solver of one's own has it.
ClothState settle(const ComparisonScene& scene, Stepper& stepper, const ProgressFunction& progress);

/// Converged steps of the frame's length.
/// @param begun  the states so far, the start at least; gets as many as `frames` need
Trajectory coarse_reference(const ComparisonScene& scene, Trajectory begun, int frames,
                            const ProgressFunction& progress);

/// The fine reference: eight converged steps of 1/240 s per frame.
Trajectory fine_reference(const ComparisonScene& scene, Trajectory begun, int frames,
                          const ProgressFunction& progress);

}  // namespace cloth
