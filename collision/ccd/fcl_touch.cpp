#include "collision/ccd/fcl_touch.h"

#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

namespace cloth {

// FCL also has a closed form for the cubic. It cancels where the triangle hardly turns, and then
// loses touches.
constexpr bool interval_newton = true;

bool fcl_touch(const double (&start)[4][3], const double (&end)[4][3], double& time) {
    const auto at = [](const double(&x)[3]) { return fcl::Vector3d(x[0], x[1], x[2]); };
    double touch = 0.0;
    fcl::Vector3d point;
    if (!fcl::detail::Intersect<double>::intersect_VF_filtered(
            at(start[0]), at(start[1]), at(start[2]), at(start[3]), at(end[0]), at(end[1]),
            at(end[2]), at(end[3]), &touch, &point, interval_newton))
        return false;
    time = touch;
    return true;
}

}  // namespace cloth
