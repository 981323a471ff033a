#include "bullet_ext/partDistance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "data/core/errors.h"

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

Faces facesWithArea(const Points& x, const Faces& faces) {
    constexpr double kLeast = 1e-14;  // m^2
    const VectorX areas = face_area_vectors(x, faces).rowwise().norm();
    std::vector<Eigen::Index> kept;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        if (areas[f] > kLeast && std::isfinite(areas[f])) kept.push_back(f);
    Faces rest(static_cast<Eigen::Index>(kept.size()), 3);
    for (size_t k = 0; k < kept.size(); ++k)
        rest.row(static_cast<Eigen::Index>(k)) = faces.row(kept[k]);
    return rest;
}

/// Every face with corners of its own.
TriMesh triangleSoup(const Points& x, const Faces& faces) {
    TriMesh soup{Points(3 * faces.rows(), 3), Faces(faces.rows(), 3)};
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            soup.faces(f, c) = static_cast<int>(3 * f) + c;
            soup.vertices.row(3 * f + c) = x.row(faces(f, c));
        }
    return soup;
}

/// Null if the mesh has no surface. Where more than two faces meet in an edge, Bullet's users may
/// well have such meshes, inside and outside are those of the nearest face.
std::unique_ptr<SurfaceDistance> distanceTo(const Points& x, const Faces& all) {
    const Faces faces = facesWithArea(x, all);
    if (faces.rows() == 0) return nullptr;
    try {
        return std::make_unique<SurfaceDistance>(TriMesh{x, faces});
    } catch (const ArgumentError&) {
        return std::make_unique<SurfaceDistance>(triangleSoup(x, faces));
    }
}

}  // namespace

PartDistance::PartDistance(const ShapePart& part) : m_part(part), m_inverse(part.frame.inverse()) {
    if (part.shape != ObstacleShape::mesh) return;
    m_low = part.vertices.colwise().minCoeff();
    m_high = part.vertices.colwise().maxCoeff();
    m_mesh = distanceTo(part.vertices, *part.faces);
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
            if (!m_mesh || (point.array() < m_low.array() - radius).any() ||
                (point.array() > m_high.array() + radius).any())
                return distance;
            return m_mesh->nearest(point, radius).distance;
    }
    return distance <= radius ? distance : std::numeric_limits<double>::infinity();
}

}  // namespace cloth
