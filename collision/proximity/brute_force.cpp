#include "collision/proximity/brute_force.h"

#include <array>
#include <cmath>
#include <limits>

#include "data/core/primitives.h"
#include "data/core/triangle.h"

namespace cloth {

static std::array<Vec3, 3> corners_of(const TriMesh& mesh, Eigen::Index face) {
    return {Vec3(mesh.vertices.row(mesh.faces(face, 0))),
            Vec3(mesh.vertices.row(mesh.faces(face, 1))),
            Vec3(mesh.vertices.row(mesh.faces(face, 2)))};
}

std::optional<SurfacePoint> brute_force_closest(const TriMesh& mesh, const Vec3& q) {
    std::optional<SurfacePoint> best;
    double squared = std::numeric_limits<double>::infinity();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const auto [a, b, c] = corners_of(mesh, f);
        if (!has_area(a, b, c)) continue;
        const TriangleHit hit = closest_on_triangle(q, a, b, c);
        if (!(hit.squared < squared)) continue;
        squared = hit.squared;
        const Vec3& w = hit.barycentric;
        best = SurfacePoint{static_cast<int>(f), w, w[0] * a + w[1] * b + w[2] * c,
                            std::sqrt(squared)};
    }
    return best;
}

/// Sum over the faces that touch all `feature` points (one: a vertex, two: an edge) of the face
/// normal times the angle under which the face meets the feature (pi at an edge).
static Vec3 pseudonormal(const TriMesh& mesh, const std::vector<Vec3>& feature) {
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const auto corners = corners_of(mesh, f);
        size_t shared = 0, pivot = 0;
        for (size_t k = 0; k < 3; ++k)
            for (const Vec3& x : feature)
                if (corners[k] == x) ++shared, pivot = k;
        Vec3 normal;
        if (shared != feature.size() ||
            !triangle_normal(corners[0], corners[1], corners[2], normal))
            continue;
        const Vec3 u = (corners[(pivot + 1) % 3] - corners[pivot]).normalized();
        const Vec3 v = (corners[(pivot + 2) % 3] - corners[pivot]).normalized();
        const double angle = std::acos(std::max(-1.0, std::min(1.0, u.dot(v))));
        sum += (feature.size() == 1 ? angle : M_PI) * normal;
    }
    return sum;
}

double brute_force_signed_distance(const TriMesh& mesh, const Vec3& q) {
    const auto closest = brute_force_closest(mesh, q);
    if (!closest) return std::numeric_limits<double>::infinity();
    const auto corners = corners_of(mesh, closest->face);
    std::vector<Vec3> feature;
    for (int k = 0; k < 3; ++k)
        if (closest->barycentric[k] != 0.0) feature.push_back(corners[size_t(k)]);
    Vec3 normal;
    triangle_normal(corners[0], corners[1], corners[2], normal);
    if (feature.size() < 3) normal = pseudonormal(mesh, feature);
    return (q - closest->point).dot(normal) < 0.0 ? -closest->distance : closest->distance;
}

double brute_force_signed_distance(const Boundary& boundary, StepEnd end, const Vec3& q) {
    const bool start = end == StepEnd::start;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Obstacle& obstacle : boundary.obstacles) {
        double distance = 0.0;
        if (obstacle.shape == ObstacleShape::mesh) {
            const TriMesh mesh{start ? obstacle.x0 : obstacle.x1, *obstacle.faces};
            distance = brute_force_signed_distance(mesh, q);
        } else {
            const Pose& pose = start ? obstacle.pose0 : obstacle.pose1;
            distance = closest_on_primitive(obstacle, pose.inverse() * q).distance;
        }
        nearest = std::min(nearest, distance);
    }
    return nearest;
}

}  // namespace cloth
