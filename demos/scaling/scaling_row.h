#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/compare/rollout.h"

namespace cloth {

/// What one solver takes for one garment.
struct ScalingRow {
    std::string scene, solver;
    int vertices = 0;
    int frames = 0;  ///< that were measured
    double ms_median = 0.0, ms_p95 = 0.0;
    double proximity_ms = 0.0, features_ms = 0.0, solve_ms = 0.0, contact_ms = 0.0;  ///< medians
    double setup_ms = 0.0;
    double memory_mb = 0.0;
    std::string failure;  ///< empty: the rollout held

    double us_per_vertex() const { return 1e3 * ms_median / vertices; }
};

/// The times of a rollout's frames after the first `warm_up`.
ScalingRow make_scaling_row(const Rollout& rollout, int warm_up);

/// The row as a JSON object; null for what is not finite.
nlohmann::ordered_json to_json(const ScalingRow& row);

/// Time per vertex against the number of vertices as SVG: a colour per solver, scenes but the first
/// dashed.
std::string scaling_plot(const std::vector<ScalingRow>& rows, int threads);

}  // namespace cloth
