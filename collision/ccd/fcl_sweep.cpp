#include "collision/ccd/fcl_sweep.h"

#include <algorithm>
#include <cmath>

#include "collision/ccd/fcl_touch.h"

namespace cloth {

bool first_touch(const Vec3& p0, const Vec3& p1, const std::array<Vec3, 3>& start,
                 const std::array<Vec3, 3>& end, double& time) {
    // FCL is given triangles of the order of 1.
    const Vec3& origin = start[0];
    const double size = std::sqrt(std::max((start[1] - origin).cross(start[2] - origin).norm(),
                                           (end[1] - end[0]).cross(end[2] - end[0]).norm()));
    if (!(size > 0.0)) return false;
    double local_start[4][3], local_end[4][3];
    const auto put = [&](const Vec3& x, double(&to)[3]) {
        const Vec3 local = (x - origin) / size;
        std::copy_n(local.data(), 3, to);
    };
    for (size_t k = 0; k < 3; ++k) {
        put(start[k], local_start[k]);
        put(end[k], local_end[k]);
    }
    put(p0, local_start[3]);
    put(p1, local_end[3]);
    double touch = 0.0;
    if (!fcl_touch(local_start, local_end, touch)) return false;
    time = std::clamp(touch, 0.0, 1.0);
    return true;
}

}  // namespace cloth
