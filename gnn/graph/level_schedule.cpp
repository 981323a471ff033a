#include "gnn/graph/level_schedule.h"

#include <algorithm>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

LevelSchedule down_and_up(int steps, int levels) {
    check_range("coarse levels", levels, 1, max_coarse_levels);
    const int stages = 2 * levels + 1;
    if (steps < stages)
        throw ArgumentError("steps", "are " + std::to_string(steps),
                            "down to level " + std::to_string(levels) + " and up again takes " +
                                std::to_string(stages) + " or more");
    LevelSchedule schedule;
    for (int stage = 0; stage < stages; ++stage) {
        const int from_end = std::min(stage, stages - 1 - stage);
        const int turn = 2 * from_end + (stage < levels ? 1 : 0);
        std::vector<int> used = {from_end};
        if (from_end < levels) used.push_back(from_end + 1);
        const int count = steps / stages + (turn < steps % stages ? 1 : 0);
        schedule.insert(schedule.end(), static_cast<size_t>(count), used);
    }
    return schedule;
}

int coarsest_level(const LevelSchedule& schedule) {
    int coarsest = 0;
    for (const std::vector<int>& used : schedule)
        for (const int level : used) coarsest = std::max(coarsest, level);
    return coarsest;
}

/// What is wrong with the levels of one step; empty: nothing.
static std::string problem_of(const std::vector<int>& used) {
    if (used.empty() || used.size() > 2) return "must have one or two levels";
    if (used.size() == 2 && used[0] >= used[1]) return "must have the finer level first";
    if (used.front() < 0 || used.back() > max_coarse_levels)
        return "must have levels of 0 to " + std::to_string(max_coarse_levels);
    return "";
}

void check_levels(const std::string& owner, int steps, Pooling pooling,
                  const LevelSchedule& schedule) {
    const char* const remedy = "see LevelSchedule";
    const size_t count = pooling == Pooling::none ? 0 : static_cast<size_t>(steps);
    if (schedule.size() != count)
        throw ArgumentError(owner + ".level_schedule",
                            "is of " + std::to_string(schedule.size()) + " steps and not of " +
                                std::to_string(count),
                            remedy);
    for (size_t k = 0; k < schedule.size(); ++k) {
        const std::string problem = problem_of(schedule[k]);
        if (!problem.empty())
            throw ArgumentError(owner + ".level_schedule, step " + std::to_string(k), problem,
                                remedy);
    }
}

}  // namespace cloth
