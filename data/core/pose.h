#pragma once

#include "data/core/types.h"

namespace cloth {

using Pose = Eigen::Isometry3d;

/// The pose at `s` on the way from a (s = 0) to b (s = 1): straight, and turned evenly the shorter
/// way about one axis (slerp). Beyond [0, 1] the motion goes on. The ends are a and b bit for bit,
/// and so is every pose between two that are equal.
Pose interpolate(const Pose& a, const Pose& b, double s);

/// The smallest turn that takes the direction of `from` to that of `to` (any lengths but zero).
/// Opposite directions have many: one of them.
Eigen::Quaterniond rotation_between(const Vec3& from, const Vec3& to);

/// Points (N x 3, m) given in the frame `pose`, in the frame that `pose` is given in.
Points transformed(const Points& points, const Pose& pose);

}  // namespace cloth
