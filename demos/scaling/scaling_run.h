#pragma once

#include <string>
#include <vector>

#include "demos/compare/references.h"
#include "demos/compare/solver_factory.h"
#include "demos/scaling/scaling_row.h"
#include "demos/scaling/sized_scene.h"

namespace cloth {

struct ScalingSettings {
    std::vector<std::string> solvers;  ///< names that make_solver() knows
    SolverSettings solver;
    int warm_up = 3;  ///< frames of the scene that are not measured
};

/// Makes the scene and the solvers, lets the garment settle by ten iterations a frame, and lets the
/// solvers take turns.
/// @return one row per solver, in order
/// @throws UsageError for an unknown scene or solver, LoadError for a file that cannot be used
std::vector<ScalingRow> measure_size(const SizedSceneSettings& scene,
                                     const ScalingSettings& settings,
                                     const ProgressFunction& progress);

}  // namespace cloth
