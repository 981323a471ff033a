#include "bullet_ext/partDistance.h"

#include <cmath>
#include <vector>

#include "data/core/errors.h"
#include "data/core/primitives.h"

namespace cloth {

namespace {

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

PartDistance::PartDistance(const ShapePart& part) : m_inverse(part.frame.inverse()) {
    m_primitive.shape = part.shape;
    m_primitive.half_extents = part.half_extents;
    m_primitive.radius = part.radius;
    m_extent = reach_of_primitive(m_primitive);
    if (part.shape != ObstacleShape::mesh) return;
    m_low = part.vertices.colwise().minCoeff();
    m_high = part.vertices.colwise().maxCoeff();
    m_mesh = distanceTo(part.vertices, *part.faces);
}

std::optional<double> PartDistance::at(const Vec3& point, double radius) const {
    if (m_primitive.shape != ObstacleShape::mesh) {
        constexpr double kRounding = 1e-9;  // m
        const Vec3 local = m_inverse * point;
        if (local.norm() > m_extent + radius + kRounding) return std::nullopt;
        const double distance = distance_to_primitive(m_primitive, local);
        return distance <= radius ? std::optional(distance) : std::nullopt;
    }
    if (!m_mesh || (point.array() < m_low.array() - radius).any() ||
        (point.array() > m_high.array() + radius).any())
        return std::nullopt;
    const auto nearest = m_mesh->nearest_within(radius, point);
    return nearest ? std::optional(nearest->distance) : std::nullopt;
}

}  // namespace cloth
