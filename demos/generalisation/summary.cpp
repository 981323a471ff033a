#include "demos/generalisation/summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include "demos/compare/json_numbers.h"
#include "demos/compare/statistics.h"

namespace cloth {
namespace {

double geometric_mean(const std::vector<double>& ratios) {
    std::vector<double> logarithms;
    for (const double ratio : ratios)
        if (std::isfinite(ratio) && ratio > 0.0) logarithms.push_back(std::log(ratio));
    return logarithms.empty() ? SolverRow::none : std::exp(mean(logarithms));
}

/// Solvers of small steps, such as `default` and `small60+2s60`, are not after the minimum of a
/// whole one.
bool takes_whole_steps(const std::string& solver) {
    static const std::regex small_steps("^default|[0-9]s[0-9]+");
    return !std::regex_search(solver, small_steps);
}

/// All that one solver did in a group.
struct Collected {
    int failed = 0;
    std::vector<double> gap, rollout, relative_gap, relative_rollout;

    int scenes = 0;

    void add(const SolverRow& row, const SolverRow& other, bool minimum_known) {
        ++scenes;
        if (minimum_known && takes_whole_steps(row.solver)) {
            gap.push_back(row.gap_median);
            relative_gap.push_back(row.gap_median / other.gap_median);
        }
        if (row.first_failed_frame) ++failed;
        if (row.first_failed_frame || other.first_failed_frame) return;
        rollout.push_back(row.fine_rmse_mm);
        relative_rollout.push_back(row.fine_rmse_mm / other.fine_rmse_mm);
    }
};

}  // namespace

std::vector<GroupSummary> summarise(const std::string& group, const std::vector<SolverRow>& rows,
                                    const std::string& relative_to) {
    std::vector<std::string> solvers;
    for (const SolverRow& row : rows)
        if (std::find(solvers.begin(), solvers.end(), row.solver) == solvers.end())
            solvers.push_back(row.solver);
    std::map<std::string, Collected> collected;
    for (size_t first = 0; first < rows.size(); first += solvers.size()) {
        const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(first);
        const auto end = begin + static_cast<std::ptrdiff_t>(solvers.size());
        const auto other = std::find_if(
            begin, end, [&](const SolverRow& row) { return row.solver == relative_to; });
        const bool minimum_known = std::all_of(begin, end, [](const SolverRow& row) {
            return row.gap_median >= 0.0 || !takes_whole_steps(row.solver);
        });
        for (auto row = begin; row != end; ++row)
            collected[row->solver].add(*row, *other, minimum_known);
    }
    std::vector<GroupSummary> summaries;
    for (const std::string& solver : solvers) {
        const Collected& all = collected[solver];
        summaries.push_back({group, solver, all.scenes, all.failed,
                             static_cast<int>(all.gap.size()), mean(all.gap), mean(all.rollout),
                             geometric_mean(all.relative_gap),
                             geometric_mean(all.relative_rollout)});
    }
    return summaries;
}

nlohmann::ordered_json to_json(const GroupSummary& summary) {
    return {{"group", summary.group},
            {"solver", summary.solver},
            {"scenes", summary.scenes},
            {"failed", summary.failed},
            {"gap_scenes", summary.gap_scenes},
            {"gap", rounded_number(summary.gap)},
            {"rollout_mm", rounded_number(summary.rollout_mm)},
            {"relative_gap", rounded_number(summary.relative_gap)},
            {"relative_rollout", rounded_number(summary.relative_rollout)}};
}

}  // namespace cloth
