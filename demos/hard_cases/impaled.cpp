#include "demos/hard_cases/hard_run.h"

namespace cloth {
namespace {

/// Moeller and Trumbore 1997, for the segment from p to q.
bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 way = q - p, ab = b - a, ac = c - a;
    const Vec3 h = way.cross(ac);
    const double determinant = ab.dot(h);
    if (determinant == 0.0) return false;
    const Vec3 s = (p - a) / determinant;
    const double u = s.dot(h);
    const Vec3 k = s.cross(ab);
    const double v = way.dot(k), t = ac.dot(k);
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= 1.0;
}

}  // namespace

bool is_impaled(const Boundary& boundary, const Faces& faces, const Points& x) {
    for (const Obstacle& limb : boundary.obstacles) {
        if (limb.shape != ObstacleShape::capsule) continue;
        const Vec3 half(0.0, limb.half_extents.y(), 0.0);
        const Vec3 p = limb.pose1 * Vec3(-half), q = limb.pose1 * half;
        for (Eigen::Index f = 0; f < faces.rows(); ++f)
            if (crosses(p, q, x.row(faces(f, 0)), x.row(faces(f, 1)), x.row(faces(f, 2))))
                return true;
    }
    return false;
}

}  // namespace cloth
