#pragma once

#include <string>
#include <vector>

#include "demos/compare/measure.h"
#include "demos/compare/rollout.h"
#include "demos/compare/single_steps.h"

namespace cloth {

/// A solver that takes part, warmed up.
struct Contestant {
    std::string name;
    WarmStepper warm;
};

struct ContestResult {
    Rollout rollout;
    SingleSteps single;
};

/// Lets all solvers take turns: frame by frame each advances its own rollout, so that all meet the
/// same machine. A solver whose rollout stops being finite leaves, the others go on.
/// @param references  may be empty: there are no errors then
/// @return one rollout per contestant, in order
std::vector<Rollout> roll_out(const ComparisonScene& scene, const ClothState& start,
                              const References& references,
                              const std::vector<Contestant>& contestants,
                              const ProgressFunction& progress);

/// Frame by frame each makes a single step from the reference's state, in turns.
/// @return one entry per contestant, in order
std::vector<SingleSteps> make_single_steps(const ComparisonScene& scene,
                                           const References& references,
                                           const std::vector<Contestant>& contestants,
                                           const ProgressFunction& progress);

/// roll_out(), then frame by frame each makes a single step from the reference's state.
/// @return one result per contestant, in order
std::vector<ContestResult> run_contest(const ComparisonScene& scene, const ClothState& start,
                                       const References& references,
                                       const std::vector<Contestant>& contestants,
                                       const ProgressFunction& progress);

}  // namespace cloth
