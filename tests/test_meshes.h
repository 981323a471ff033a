#pragma once

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "data/core/boundary.h"
#include "data/core/mesh.h"

/// Meshes, obstacles and random points that tests of several modules share.
namespace cloth::test {

inline double uniform(std::mt19937& random, double low, double high) {
    return low + (high - low) * (random() / 4294967296.0);  // the same on every platform
}

inline Vec3 random_point(std::mt19937& random, double half_width) {
    const double x = uniform(random, -half_width, half_width);
    const double y = uniform(random, -half_width, half_width);
    return {x, y, uniform(random, -half_width, half_width)};
}

inline Points random_points(std::mt19937& random, Eigen::Index count, double half_width) {
    Points points(count, 3);
    for (Eigen::Index i = 0; i < count; ++i) points.row(i) = random_point(random, half_width);
    return points;
}

/// Sphere of radius 1 from an icosahedron, each subdivision quarters the faces (20 * 4^n).
inline TriMesh icosphere(int subdivisions) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points{{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                             {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                             {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<int, 3>> faces{
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int pass = 0; pass < subdivisions; ++pass) {
        std::map<std::array<int, 2>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [place, fresh] =
                middles.emplace(std::array<int, 2>{std::min(a, b), std::max(a, b)},
                                static_cast<int>(points.size()));
            if (fresh) points.push_back(0.5 * (points[size_t(a)] + points[size_t(b)]));
            return place->second;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = finer;
    }
    TriMesh mesh{Points(points.size(), 3), Faces(faces.size(), 3)};
    for (size_t i = 0; i < points.size(); ++i)
        mesh.vertices.row(Eigen::Index(i)) = points[i].normalized();
    for (size_t f = 0; f < faces.size(); ++f)
        mesh.faces.row(Eigen::Index(f)) << faces[f][0], faces[f][1], faces[f][2];
    return mesh;
}

/// A level sheet of n x n vertices from (0, 0, 0) to (1, 0, 1), faces upward.
inline TriMesh square_mesh(int n) {
    TriMesh mesh;
    mesh.vertices.resize(n * n, 3);
    mesh.faces.resize(2 * (n - 1) * (n - 1), 3);
    for (int j = 0, f = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            mesh.vertices.row(j * n + i) << i / (n - 1.0), 0, j / (n - 1.0);
            if (i + 1 == n || j + 1 == n) continue;
            const int a = j * n + i;
            mesh.faces.row(f++) << a, a + n, a + 1;
            mesh.faces.row(f++) << a + 1, a + n, a + n + 1;
        }
    return mesh;
}

/// A closed sphere at the origin of `rings` rings of 2 rings vertices and two poles.
inline TriMesh sphere_mesh(double radius, int rings) {
    const int around = 2 * rings;
    TriMesh mesh;
    mesh.vertices.resize(rings * around + 2, 3);
    mesh.faces.resize(2 * rings * around, 3);
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < around; ++s) {
            const double t = M_PI * (r + 1) / (rings + 1), p = 2.0 * M_PI * s / around;
            mesh.vertices.row(r * around + s) << radius * std::sin(t) * std::cos(p),
                radius * std::cos(t), radius * std::sin(t) * std::sin(p);
        }
    const int top = rings * around, bottom = top + 1;
    mesh.vertices.row(top) << 0, radius, 0;
    mesh.vertices.row(bottom) << 0, -radius, 0;
    for (int s = 0, f = 0; s < around; ++s) {
        const int next = (s + 1) % around, last = (rings - 1) * around;
        mesh.faces.row(f++) << top, next, s;
        mesh.faces.row(f++) << bottom, last + s, last + next;
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * around;
            mesh.faces.row(f++) << a + s, a + next, a + around + s;
            mesh.faces.row(f++) << a + next, a + around + next, a + around + s;
        }
    }
    return mesh;
}

/// Torus around the y axis: `rings` x `sides` quads, each cut in two.
inline TriMesh torus(int rings, int sides, double major, double minor) {
    TriMesh mesh{Points(rings * sides, 3), Faces(2 * rings * sides, 3)};
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sides; ++j) {
            const double u = 2 * M_PI * i / rings, v = 2 * M_PI * j / sides;
            const double r = major + minor * std::cos(v);
            const int at = i * sides + j, right = ((i + 1) % rings) * sides + j;
            const int up = i * sides + (j + 1) % sides;
            const int both = ((i + 1) % rings) * sides + (j + 1) % sides;
            mesh.vertices.row(at) << r * std::cos(u), minor * std::sin(v), r * std::sin(u);
            mesh.faces.row(2 * at) << at, up, both;
            mesh.faces.row(2 * at + 1) << at, both, right;
        }
    return mesh;
}

/// The mesh with every vertex moved along the line to the origin by up to `amount` of its length:
/// a closed, star-shaped, spiky surface with acute edges and corners.
inline TriMesh roughened(TriMesh mesh, double amount, unsigned seed) {
    std::mt19937 random(seed);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        mesh.vertices.row(i) *= 1 + uniform(random, -amount, amount);
    return mesh;
}

/// Cube of side 2 around the origin, two triangles a side.
inline TriMesh cube() {
    TriMesh mesh{Points(8, 3), Faces(12, 3)};
    for (int i = 0; i < 8; ++i)
        mesh.vertices.row(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
    mesh.faces << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
        0, 6, 2, 1, 3, 7, 1, 7, 5;
    return mesh;
}

/// The same surface with three vertices of its own for each face.
inline TriMesh triangle_soup(const TriMesh& mesh) {
    TriMesh soup{Points(mesh.faces.size(), 3), Faces(mesh.faces.rows(), 3)};
    for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) {
        soup.vertices.row(i) = mesh.vertices.row(mesh.faces.data()[i]);
        soup.faces.data()[i] = static_cast<int>(i);
    }
    return soup;
}

inline Pose pose_of(const Vec3& translation, double angle = 0.0, const Vec3& axis = {0, 1, 0}) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
    pose.translation() = translation;
    return pose;
}

inline Obstacle primitive(ObstacleShape shape, const Vec3& half_extents, double radius) {
    Obstacle obstacle;
    obstacle.shape = shape;
    obstacle.half_extents = half_extents;
    obstacle.radius = radius;
    return obstacle;
}

inline Boundary boundary_of(std::vector<Obstacle> obstacles) {
    Boundary boundary;
    boundary.obstacles = std::move(obstacles);
    return boundary;
}

inline Obstacle mesh_obstacle(const TriMesh& mesh) {
    Obstacle obstacle;
    obstacle.faces = std::make_shared<const Faces>(mesh.faces);
    obstacle.x0 = obstacle.x1 = mesh.vertices;
    return obstacle;
}

}  // namespace cloth::test
