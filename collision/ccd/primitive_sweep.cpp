#include "collision/ccd/primitive_sweep.h"

#include <limits>

namespace cloth {

constexpr double touching = 1e-6;  // m
constexpr int max_advances = 200;  // a path that follows the surface closely does not go through it

static bool advance(const Obstacle& primitive, const Vec3& from, const Vec3& to,
                    PrimitiveHit& hit) {
    const double start = distance_to_primitive(primitive, from), length = (to - from).norm();
    if (start > length) return false;
    Vec3 at = from;
    double distance = start, way = 0.0;
    for (int k = 0; k < max_advances && distance > touching; ++k) {
        way += distance;
        if (way > length) return false;
        at = from + (way / length) * (to - from);
        distance = distance_to_primitive(primitive, at);
    }
    hit = closest_on_primitive(primitive, at);
    hit.distance = start;
    return distance <= touching;
}

PrimitivePath follow_path(const Obstacle& primitive, const Vec3& p0, const Vec3& p1) {
    PrimitivePath path;
    path.meets = advance(primitive, p0, p1, path.in) && advance(primitive, p1, p0, path.out);
    return path;
}

double unreachable_distance(const Obstacle& primitive, double longest_way) {
    constexpr double rounding = 1.0 + 1e-5;  // frames are turned as exactly as floats are
    const Pose &from = primitive.pose0, &to = primitive.pose1;
    const double turn = (to.linear() - from.linear()).norm();
    if (!(turn < 1.0)) return std::numeric_limits<double>::infinity();
    const double way = longest_way + (to.translation() - from.translation()).norm();
    return rounding * (reach_of_primitive(primitive) + way) / (1.0 - turn);
}

}  // namespace cloth
