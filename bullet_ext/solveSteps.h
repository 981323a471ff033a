#pragma once

#include <vector>

namespace cloth {

class SoftBodyStep;

/// Solves cloth steps that have begun, of different bodies: a body to a thread where that is faster
/// than one body after the other with all threads in it. The bits are the same either way.
void solveSteps(const std::vector<SoftBodyStep*>& steps);

/// Whether it is, for garments of so many vertices each.
bool areFasterTogether(const std::vector<long>& vertices, int threads);

}  // namespace cloth
