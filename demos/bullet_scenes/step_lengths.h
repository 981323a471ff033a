#pragma once

#include <vector>

namespace cloth {

/// Lengths of a world's steps.
struct StepPlan {
    int rate = 60;        ///< steps per second, 10 to 1000
    bool random = false;  ///< of 1/240 to 1/30 s instead, all equally likely
    unsigned seed = 1;    ///< of random steps: equal seeds give equal steps
};

/// (s) that end at `seconds` or less than a step after it.
std::vector<float> step_lengths(const StepPlan& plan, double seconds);

}  // namespace cloth
