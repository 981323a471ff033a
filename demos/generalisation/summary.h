#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/speed_error/solver_row.h"

namespace cloth {

/// One solver in the scenes of one group.
struct GroupSummary {
    std::string group, solver;
    int scenes = 0, failed = 0;  ///< failed: the rollout was lost or torn
    /// Scenes that the gaps are of. Where a solver ends below what Newton's method found, the
    /// minimum is not known, and the scene does not count.
    int gap_scenes = 0;
    double gap = 0.0;         ///< of one step: mean over these scenes of their medians; NaN for
                              ///< solvers of small steps
    double rollout_mm = 0.0;  ///< to the fine solution: mean over the scenes that it survived;
                              ///< NaN: none
    /// The same over those of another solver in the same scene: geometric means. They do not tell
    /// how hard a scene is, so they compare groups.
    double relative_gap = 0.0, relative_rollout = 0.0;
};

/// @param rows         of one group: scene by scene, each with every solver
/// @param relative_to  one of the solvers
std::vector<GroupSummary> summarise(const std::string& group, const std::vector<SolverRow>& rows,
                                    const std::string& relative_to);

nlohmann::ordered_json to_json(const GroupSummary& summary);

}  // namespace cloth
