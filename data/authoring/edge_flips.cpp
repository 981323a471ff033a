#include "data/authoring/edge_flips.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "data/authoring/mesh_quality.h"

namespace cloth {

namespace {

constexpr int kSmallestDegree = 4;  // a flip must leave no vertex in a flat corner of one triangle
constexpr int kStuckDegree = 3;  // an inner vertex that smoothing squeezes between its neighbours

struct Side {
    int face;
    int opposite;  ///< vertex of the face that is not on the edge
    int from, to;  ///< the edge as the face goes around it
};

Vec3 area_vector(const Points& x, int a, int b, int c) {
    const Vec3 u = x.row(b) - x.row(a), v = x.row(c) - x.row(a);
    return u.cross(v);
}

/// Whether the quad looks better with the edge p.opposite - q.opposite and stays as flat as before.
bool flip_is_better(const Points& x, const Side& p, const Side& q) {
    const double now = std::min(smallest_angle(x, {p.from, p.to, p.opposite}),
                                smallest_angle(x, {q.from, q.to, q.opposite}));
    const double then = std::min(smallest_angle(x, {p.opposite, p.from, q.opposite}),
                                 smallest_angle(x, {q.opposite, p.to, p.opposite}));
    if (then < now + 1e-4) return false;
    const Vec3 outside = area_vector(x, p.from, p.to, p.opposite).normalized() +
                         area_vector(x, q.from, q.to, q.opposite).normalized();
    const Vec3 n0 = area_vector(x, p.opposite, p.from, q.opposite).normalized();
    const Vec3 n1 = area_vector(x, q.opposite, p.to, p.opposite).normalized();
    return n0.dot(n1) > 0.9 && n0.dot(outside) > 1.6 && n1.dot(outside) > 1.6;
}

}  // namespace

int flip_edges(TriMesh& mesh) {
    std::map<std::pair<int, int>, std::vector<Side>> edges;
    for (int f = 0; f < mesh.faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int from = mesh.faces(f, c), to = mesh.faces(f, (c + 1) % 3);
            edges[std::minmax(from, to)].push_back({f, mesh.faces(f, (c + 2) % 3), from, to});
        }
    std::vector<int> degree(static_cast<size_t>(mesh.vertices.rows()), 0);
    for (const auto& [edge, sides] : edges) {
        ++degree[static_cast<size_t>(edge.first)];
        ++degree[static_cast<size_t>(edge.second)];
    }
    std::vector<char> on_border(static_cast<size_t>(mesh.vertices.rows()), 0);
    for (const auto& [edge, sides] : edges)
        if (sides.size() == 1)
            on_border[static_cast<size_t>(edge.first)] =
                on_border[static_cast<size_t>(edge.second)] = 1;
    const auto is_stuck = [&](int vertex) {
        return degree[static_cast<size_t>(vertex)] == kStuckDegree &&
               !on_border[static_cast<size_t>(vertex)];
    };
    std::set<std::pair<int, int>> created;
    std::vector<char> touched(static_cast<size_t>(mesh.faces.rows()), 0);
    int flips = 0;
    for (const auto& [edge, sides] : edges) {
        if (sides.size() != 2) continue;
        const Side &p = sides[0], &q = sides[1];
        if (touched[static_cast<size_t>(p.face)] || touched[static_cast<size_t>(q.face)]) continue;
        const std::pair<int, int> across = std::minmax(p.opposite, q.opposite);
        int& from_degree = degree[static_cast<size_t>(p.from)];
        int& to_degree = degree[static_cast<size_t>(p.to)];
        // A border has room for one edge less, if that frees a vertex.
        const bool frees = on_border[static_cast<size_t>(p.from)] &&
                           on_border[static_cast<size_t>(p.to)] &&
                           (is_stuck(p.opposite) || is_stuck(q.opposite));
        if (std::min(from_degree, to_degree) <= (frees ? kSmallestDegree - 1 : kSmallestDegree))
            continue;
        if (edges.count(across) || created.count(across)) continue;
        // Its triangles are too thin to compare: smoothing comes after the flip.
        if (!frees && !flip_is_better(mesh.vertices, p, q)) continue;
        mesh.faces.row(p.face) << p.opposite, p.from, q.opposite;
        mesh.faces.row(q.face) << q.opposite, p.to, p.opposite;
        touched[static_cast<size_t>(p.face)] = touched[static_cast<size_t>(q.face)] = 1;
        created.insert(across);
        --from_degree;
        --to_degree;
        ++degree[static_cast<size_t>(p.opposite)];
        ++degree[static_cast<size_t>(q.opposite)];
        ++flips;
    }
    return flips;
}

}  // namespace cloth
