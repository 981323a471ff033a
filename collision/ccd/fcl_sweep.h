#pragma once

#include <array>

#include "data/core/types.h"

namespace cloth {

/// Whether a point that moves evenly from p0 to p1 meets a triangle whose corners move evenly from
/// `start` to `end` (m), and when first.
/// @param time  of the step, 0 to 1; unchanged if they do not meet
bool first_touch(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& start,
                 const std::array<Vec3, 3>& end, double& time);

}  // namespace cloth
