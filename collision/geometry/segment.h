#pragma once

#include <algorithm>

#include "data/core/types.h"

namespace cloth {

/// The points of two segments that are closest to each other.
struct SegmentHit {
    double s = 0.0, t = 0.0;  ///< along the first and the second segment, 0 to 1
    double squared = 0.0;     ///< squared distance (m^2)
};

/// Closest points of the segments p0-p1 and q0-q1. Ericson, Real-Time Collision Detection (2005),
/// 5.1.9. Of parallel segments any pair of closest points; a segment without length is a point.
inline SegmentHit closest_on_segments(const Vec3& p0, const Vec3& p1, const Vec3& q0,
                                      const Vec3& q1) {
    const Vec3 u = p1 - p0, v = q1 - q0, r = p0 - q0;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
    const double ur = u.dot(r), vr = v.dot(r);
    const auto clamped = [](double above, double below) {
        return below > 0.0 ? std::clamp(above / below, 0.0, 1.0) : 0.0;
    };
    SegmentHit hit;
    hit.s = clamped(uv * vr - ur * vv, uu * vv - uv * uv);
    hit.t = clamped(uv * hit.s + vr, vv);
    // t may have been clamped: the best s for it, and no other t is better for that s.
    hit.s = clamped(uv * hit.t - ur, uu);
    hit.squared = (r + hit.s * u - hit.t * v).squaredNorm();
    return hit;
}

}  // namespace cloth
