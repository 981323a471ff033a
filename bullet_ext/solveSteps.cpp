#include "bullet_ext/solveSteps.h"

#include <omp.h>

#include <algorithm>
#include <numeric>

#include "bullet_ext/softBodyStep.h"

namespace cloth {

bool areFasterTogether(const std::vector<long>& vertices, int threads) {
    constexpr double kShare = 0.7;  // of n threads that a step makes use of: two, on 1,000 vertices
    constexpr long kWorthwhile = 500;  // vertices: less is done before threads have woken up
    const long all = std::accumulate(vertices.begin(), vertices.end(), 0L);
    if (threads < 2 || vertices.size() < 2 || all < kWorthwhile) return false;
    const long largest = *std::max_element(vertices.begin(), vertices.end());
    return static_cast<double>(all) > kShare * threads * static_cast<double>(largest);
}

void solveSteps(const std::vector<SoftBodyStep*>& steps) {
    std::vector<long> vertices;
    for (const SoftBodyStep* step : steps) vertices.push_back(step->garment().vertex_count());
    // Not by a clause of the pragma: a region of one thread is one, and regions within regions make
    // their threads anew each time.
    const int threads = omp_get_max_threads();
    if (!areFasterTogether(vertices, threads)) {
        for (SoftBodyStep* step : steps) step->solve();
        return;
    }
    const int count = static_cast<int>(steps.size());
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (int k = 0; k < count; ++k) steps[static_cast<size_t>(k)]->solve();
}

}  // namespace cloth
