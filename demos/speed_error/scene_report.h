#pragma once

#include <string>
#include <vector>

#include "demos/compare/references.h"
#include "demos/compare/solver_factory.h"
#include "demos/speed_error/scenes.h"
#include "demos/speed_error/solver_row.h"

namespace cloth {

/// Who is measured, and how.
struct ContestSettings {
    std::vector<std::string> solvers;  ///< names that make_solver() knows
    std::string relative_to;           ///< if it is one of them: see SolverRow::ms_ratio
    SolverSettings solver;
    std::string work;  ///< folder that keeps the references
};

/// What the figures of a scene mean.
struct SceneReport {
    nlohmann::ordered_json description;
    std::vector<SolverRow> rows;  ///< one per solver, in order
};

/// Makes the scene, its references and the solvers, and lets them take turns.
/// @throws UsageError for an unknown scene or solver, LoadError for a file that cannot be used
SceneReport measure_scene(const SceneSettings& scene, const ContestSettings& settings,
                          const ProgressFunction& progress);

}  // namespace cloth
