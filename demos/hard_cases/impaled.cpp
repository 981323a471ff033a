#include "data/core/triangle.h"
#include "demos/hard_cases/hard_run.h"

namespace cloth {
namespace {

/// Whether the segment from p to q goes through the triangle abc.
bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto hit = meet_line(p, q - p, a, b, c);
    return hit && hit->is_inside() && hit->at >= 0.0 && hit->at <= 1.0;
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
