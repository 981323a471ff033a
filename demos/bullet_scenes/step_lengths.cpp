#include "demos/bullet_scenes/step_lengths.h"

#include <cmath>
#include <random>

namespace cloth {

std::vector<float> step_lengths(const StepPlan& plan, double seconds) {
    constexpr double kShortest = 1.0 / 240.0, kLongest = 1.0 / 30.0;
    if (!plan.random)
        return std::vector<float>(static_cast<size_t>(std::lround(seconds * plan.rate)),
                                  1.0f / static_cast<float>(plan.rate));
    std::vector<float> steps;
    std::mt19937 random(plan.seed);  // its numbers are the same everywhere, distributions' are not
    for (double time = 0.0; time < seconds; time += static_cast<double>(steps.back())) {
        const double part = static_cast<double>(random()) / std::mt19937::max();
        steps.push_back(static_cast<float>(kShortest + part * (kLongest - kShortest)));
    }
    return steps;
}

}  // namespace cloth
