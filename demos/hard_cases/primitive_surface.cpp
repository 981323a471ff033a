#include <cmath>

#include "demos/hard_cases/pictures.h"

namespace cloth {
namespace {

constexpr int rings = 16, sectors = 24;

/// Unit sphere, poles along y; the two halves of its equator can be pulled apart.
TriMesh round_surface(double radius, double half) {
    TriMesh mesh{Points((rings + 1) * sectors, 3), Faces(2 * rings * sectors, 3)};
    Eigen::Index f = 0;
    for (int i = 0; i <= rings; ++i)
        for (int k = 0; k < sectors; ++k) {
            const double latitude = M_PI * i / rings - 0.5 * M_PI, turn = 2.0 * M_PI * k / sectors;
            const double y = radius * std::sin(latitude), r = radius * std::cos(latitude);
            mesh.vertices.row(i * sectors + k) << r * std::sin(turn),
                y + (2 * i < rings ? -half : half), r * std::cos(turn);
            if (i == rings) continue;
            const int a = i * sectors + k, b = i * sectors + (k + 1) % sectors;
            mesh.faces.row(f++) << a, b, b + sectors;
            mesh.faces.row(f++) << a, b + sectors, a + sectors;
        }
    return mesh;
}

/// Four corners of its own for each side, so that edges are sharp.
TriMesh box_surface(const Vec3& half) {
    TriMesh mesh{Points(24, 3), Faces(12, 3)};
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double sign = side % 2 == 0 ? 1.0 : -1.0;
        for (int corner = 0; corner < 4; ++corner) {
            Vec3 p = half;
            p[axis] *= sign;
            p[u] *= (corner == 1 || corner == 2 ? 1.0 : -1.0) * sign;
            p[v] *= corner >= 2 ? 1.0 : -1.0;
            mesh.vertices.row(4 * side + corner) = p;
        }
        mesh.faces.row(2 * side) << 4 * side, 4 * side + 1, 4 * side + 2;
        mesh.faces.row(2 * side + 1) << 4 * side, 4 * side + 2, 4 * side + 3;
    }
    return mesh;
}

}  // namespace

TriMesh surface_of(const Obstacle& obstacle) {
    if (obstacle.shape == ObstacleShape::mesh) return {obstacle.x1, *obstacle.faces};
    TriMesh mesh = obstacle.shape == ObstacleShape::box
                       ? box_surface(obstacle.half_extents)
                       : round_surface(obstacle.radius, obstacle.half_extents.y());
    mesh.vertices = transformed(mesh.vertices, obstacle.pose1);
    return mesh;
}

}  // namespace cloth
