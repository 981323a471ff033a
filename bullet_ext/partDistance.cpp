#include "bullet_ext/partDistance.h"

#include <algorithm>
#include <limits>

namespace cloth {

namespace {

double boxDistance(const Vec3& p, const Vec3& half_extents, double rounding) {
    const Vec3 q = p.cwiseAbs() - half_extents;
    return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - rounding;
}

double capsuleDistance(const Vec3& p, double half_length, double radius) {
    const Vec3 nearest(0.0, std::clamp(p.y(), -half_length, half_length), 0.0);
    return (p - nearest).norm() - radius;
}

}  // namespace

PartDistance::PartDistance(const ShapePart& part) : m_part(part), m_inverse(part.frame.inverse()) {
    if (part.shape != ObstacleShape::mesh) return;
    m_low = part.vertices.colwise().minCoeff();
    m_high = part.vertices.colwise().maxCoeff();
    m_mesh = std::make_unique<SurfaceDistance>(TriMesh{part.vertices, *part.faces});
}

double PartDistance::at(const Vec3& point, double radius) const {
    const Vec3 local = m_inverse * point;
    double distance = std::numeric_limits<double>::infinity();
    switch (m_part.shape) {
        case ObstacleShape::sphere:
            distance = local.norm() - m_part.radius;
            break;
        case ObstacleShape::box:
            distance = boxDistance(local, m_part.half_extents, m_part.radius);
            break;
        case ObstacleShape::capsule:
            distance = capsuleDistance(local, m_part.half_extents.y(), m_part.radius);
            break;
        case ObstacleShape::plane:
            distance = local.y();
            break;
        case ObstacleShape::mesh:
            if ((point.array() < m_low.array() - radius).any() ||
                (point.array() > m_high.array() + radius).any())
                return distance;
            return m_mesh->nearest(point, radius).distance;
    }
    return distance <= radius ? distance : std::numeric_limits<double>::infinity();
}

}  // namespace cloth
