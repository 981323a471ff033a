#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/speed_error/contest.h"
#include "demos/speed_error/solver_family.h"

namespace cloth {

/// One solver's figures in one scene: a row of speed_error.csv. NaN: there is no such figure.
struct SolverRow {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    std::string scene, fabric, solver;
    std::optional<NetworkFacts> network;
    int threads = 1;
    int frames = 0;  ///< that the rollout lasted
    double ms_median = none, ms_p95 = none, ms_longest = none;
    double ms_ratio = none;  ///< median over the frames of the time over that of another solver
    double gap_median = none, progress_median = none;
    double rmse_mm = none;                               ///< single steps
    double rollout_rmse_mm = none, fine_rmse_mm = none;  ///< rollout
    double stretch_p99 = none;                           ///< median over the frames
    double penetration_max_mm = none;                    ///< none without obstacles
    double peak_memory_mb = none;
    bool finite = true;
    std::optional<int> first_failed_frame;
    std::string failure;
};

/// The figures of a contestant.
/// @param relative_to  times (ms) of the rollout of the solver that times are divided by
SolverRow make_row(const std::string& solver, const ContestResult& result,
                   const std::vector<double>& relative_to);

/// The row as a JSON object; null for what does not exist.
nlohmann::ordered_json to_json(const SolverRow& row);

/// A table with a heading, in the order of to_json(); empty for what does not exist.
std::string to_csv(const std::vector<SolverRow>& rows);

}  // namespace cloth
