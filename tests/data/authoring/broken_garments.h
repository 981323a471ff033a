#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "data/authoring/mesh_quality.h"
#include "data/core/mesh.h"
#include "data/core/mesh_pieces.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"

/// Garments of the wardrobe, damaged as files from elsewhere are.
namespace cloth::test {

inline const TriMesh& person() {
    static const TriMesh skin = load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    return skin;
}

/// As the person wears it.
inline TriMesh worn_garment(const std::string& name) {
    return {load_garment_start(name).x, load_garment_mesh(name).faces};
}

inline TriMesh turned(TriMesh mesh) {
    mesh.faces.col(1).swap(mesh.faces.col(2));
    return mesh;
}

inline TriMesh scaled(TriMesh mesh, double factor) {
    mesh.vertices *= factor;
    return mesh;
}

inline TriMesh together(const TriMesh& a, const TriMesh& b) {
    TriMesh all{Points(a.vertices.rows() + b.vertices.rows(), 3),
                Faces(a.faces.rows() + b.faces.rows(), 3)};
    all.vertices << a.vertices, b.vertices;
    all.faces << a.faces, b.faces.array() + static_cast<int>(a.vertices.rows());
    return all;
}

/// Cut in two where x = 0; the halves lie `gap` (m) apart.
inline TriMesh cut_in_two(const TriMesh& mesh, double gap) {
    std::vector<char> left, right;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        double x = 0.0;
        for (int c = 0; c < 3; ++c) x += mesh.vertices(mesh.faces(f, c), 0);
        left.push_back(x > 0.0);
        right.push_back(!(x > 0.0));
    }
    TriMesh moved = keep_faces(mesh, left);
    moved.vertices.col(0).array() += gap;
    return together(moved, keep_faces(mesh, right));
}

/// A shell with an outer side, an inner side `thickness` (m) below it and rims between them, as
/// modellers' "solidify" makes.
inline TriMesh thick(const TriMesh& mesh, double thickness) {
    TriMesh inner = mesh;
    inner.vertices -= thickness * vertex_normals(mesh.vertices, mesh.faces);
    TriMesh shell = together(mesh, turned(inner));
    const int below = static_cast<int>(mesh.vertices.rows());
    std::vector<std::array<int, 3>> rim;
    for (const std::vector<int>& loop : boundary_loops(mesh.faces))
        for (size_t k = 0; k < loop.size(); ++k) {
            const int a = loop[k], b = loop[(k + 1) % loop.size()];
            rim.push_back({b, a, a + below});
            rim.push_back({b, a + below, b + below});
        }
    const Eigen::Index first = shell.faces.rows();
    shell.faces.conservativeResize(first + static_cast<Eigen::Index>(rim.size()), 3);
    for (size_t k = 0; k < rim.size(); ++k)
        shell.faces.row(first + static_cast<Eigen::Index>(k)) << rim[k][0], rim[k][1], rim[k][2];
    return shell;
}

/// With one face more, whose corners are two of the mesh's and a new one.
inline TriMesh with_fin(TriMesh mesh, int a, int b, const Vec3& tip) {
    mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
    mesh.vertices.row(mesh.vertices.rows() - 1) = tip.transpose();
    mesh.faces.conservativeResize(mesh.faces.rows() + 1, 3);
    mesh.faces.row(mesh.faces.rows() - 1) << a, b, static_cast<int>(mesh.vertices.rows()) - 1;
    return mesh;
}

/// A band with a half twist.
inline TriMesh moebius(int segments) {
    TriMesh mesh{Points(2 * segments, 3), Faces(2 * segments, 3)};
    for (int k = 0; k < segments; ++k) {
        const double turn = 2.0 * M_PI * k / segments;
        for (int side = 0; side < 2; ++side) {
            const double w = 0.1 * (2 * side - 1);
            const double r = 0.5 + w * std::cos(turn / 2);
            mesh.vertices.row(2 * k + side) << r * std::cos(turn), w * std::sin(turn / 2),
                r * std::sin(turn);
        }
        const bool last = k + 1 == segments;
        const int a = 2 * k, b = 2 * k + 1;
        const int c = last ? 1 : a + 2, d = last ? 0 : b + 2;
        mesh.faces.row(2 * k) << a, b, c;
        mesh.faces.row(2 * k + 1) << b, d, c;
    }
    return mesh;
}

}  // namespace cloth::test
