#pragma once

#include <vector>

#include "data/core/types.h"

namespace cloth {

/// The numbers of the points (n x 3), so that each run of `run` from the first on is a group of
/// neighbours: the points are halved along the longest side of their box until the groups are that
/// small. Points that are not finite come last.
std::vector<int> spatial_order(const Points& x, int run);

}  // namespace cloth
