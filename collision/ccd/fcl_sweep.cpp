#include "collision/ccd/fcl_sweep.h"

#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include <algorithm>
#include <cmath>

namespace cloth {

// FCL also has a closed form for the cubic. It cancels where the triangle hardly turns, and then
// loses touches.
constexpr bool interval_newton = true;

bool first_touch(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& start,
                 const std::array<Vec3, 3>& end, double& time) {
    // FCL's thresholds are absolute (a point counts as inside up to 1e-5 beyond an edge): it is
    // given triangles of the order of 1.
    const Vec3& origin = start[0];
    const double size = std::sqrt(std::max((start[1] - origin).cross(start[2] - origin).norm(),
                                           (end[1] - end[0]).cross(end[2] - end[0]).norm()));
    if (!(size > 0.0)) return false;
    const auto local = [&](const Vec3& x) -> Vec3 { return (x - origin) / size; };
    double touch = 0.0;
    fcl::Vector3d point;
    if (!fcl::detail::Intersect<double>::intersect_VF_filtered(
            local(start[0]), local(start[1]), local(start[2]), local(p0), local(end[0]),
            local(end[1]), local(end[2]), local(p1), &touch, &point, interval_newton))
        return false;
    time = std::clamp(touch, 0.0, 1.0);
    return true;
}

}  // namespace cloth
