#include "data/authoring/surface_edit.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace cloth {

namespace {

TriMesh to_mesh(const std::vector<Vec3>& vertices, const std::vector<std::array<int, 3>>& faces) {
    TriMesh mesh;
    mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
    for (size_t i = 0; i < vertices.size(); ++i)
        mesh.vertices.row(static_cast<Eigen::Index>(i)) = vertices[i].transpose();
    mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (size_t f = 0; f < faces.size(); ++f)
        mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
    return mesh;
}

TriMesh without_loose_vertices(const TriMesh& mesh, const std::vector<int>& kept_faces) {
    std::vector<int> number(static_cast<size_t>(mesh.vertices.rows()), -1);
    std::vector<Vec3> vertices;
    std::vector<std::array<int, 3>> faces;
    for (int f : kept_faces) {
        std::array<int, 3> face{};
        for (int c = 0; c < 3; ++c) {
            int& n = number[static_cast<size_t>(mesh.faces(f, c))];
            if (n < 0) {
                n = static_cast<int>(vertices.size());
                vertices.push_back(mesh.vertices.row(mesh.faces(f, c)));
            }
            face[static_cast<size_t>(c)] = n;
        }
        faces.push_back(face);
    }
    return to_mesh(vertices, faces);
}

int find_root(std::vector<int>& parent, int i) {
    while (parent[static_cast<size_t>(i)] != i) i = parent[static_cast<size_t>(i)];
    return i;
}

}  // namespace

TriMesh cut_surface(const TriMesh& mesh, const VectorX& level) {
    std::vector<Vec3> vertices;
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        vertices.push_back(mesh.vertices.row(i));
    std::map<std::pair<int, int>, int> cuts;
    const auto cut = [&](int a, int b) {
        const auto [entry, is_new] = cuts.try_emplace(std::minmax(a, b), vertices.size());
        if (is_new) {
            const double t =
                std::clamp(level[a] / (level[a] - level[b]), 0.05, 0.95);  // no slivers
            vertices.push_back((1.0 - t) * vertices[static_cast<size_t>(a)] +
                               t * vertices[static_cast<size_t>(b)]);
        }
        return entry->second;
    };
    std::vector<std::array<int, 3>> faces;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        std::vector<int> polygon;
        for (int c = 0; c < 3; ++c) {
            const int a = mesh.faces(f, c), b = mesh.faces(f, (c + 1) % 3);
            if (level[a] < 0.0) polygon.push_back(a);
            if ((level[a] < 0.0) != (level[b] < 0.0)) polygon.push_back(cut(a, b));
        }
        for (size_t c = 1; c + 1 < polygon.size(); ++c)
            faces.push_back({polygon[0], polygon[c], polygon[c + 1]});
    }
    const TriMesh all = to_mesh(vertices, faces);
    std::vector<int> kept(faces.size());
    std::iota(kept.begin(), kept.end(), 0);
    return without_loose_vertices(all, kept);
}

TriMesh keep_component(const TriMesh& mesh, const Vec3& p) {
    std::vector<int> parent(static_cast<size_t>(mesh.vertices.rows()));
    std::iota(parent.begin(), parent.end(), 0);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int c = 1; c < 3; ++c) {
            const int a = find_root(parent, mesh.faces(f, 0));
            const int b = find_root(parent, mesh.faces(f, c));
            parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
        }
    Eigen::Index nearest = 0;
    (mesh.vertices.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    const int root = find_root(parent, static_cast<int>(nearest));
    std::vector<int> kept;
    for (int f = 0; f < mesh.faces.rows(); ++f)
        if (find_root(parent, mesh.faces(f, 0)) == root) kept.push_back(f);
    return without_loose_vertices(mesh, kept);
}

}  // namespace cloth
