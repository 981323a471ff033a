#include "data/authoring/mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "data/core/errors.h"
#include "data/core/mesh_pieces.h"

namespace cloth {

namespace {

using DirectedEdges = std::map<std::pair<int, int>, int>;  // (from, to) -> number of faces

DirectedEdges directed_edges(const Faces& faces) {
    DirectedEdges edges;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) ++edges[{faces(f, c), faces(f, (c + 1) % 3)}];
    return edges;
}

int find_root(std::vector<int>& parent, int i) {
    while (parent[static_cast<size_t>(i)] != i)
        i = parent[static_cast<size_t>(i)] =
            parent[static_cast<size_t>(parent[static_cast<size_t>(i)])];
    return i;
}

int count_components(const Faces& faces) {
    std::vector<int> parent(static_cast<size_t>(faces.maxCoeff()) + 1);
    std::iota(parent.begin(), parent.end(), 0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 1; c < 3; ++c)
            parent[static_cast<size_t>(find_root(parent, faces(f, c)))] =
                find_root(parent, faces(f, 0));
    std::set<int> roots;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) roots.insert(find_root(parent, faces(f, 0)));
    return static_cast<int>(roots.size());
}

/// True if the faces around each vertex form one fan: the links of the vertices are connected.
bool has_single_fans(const Faces& faces) {
    std::map<int, std::map<int, std::vector<int>>> links;  // vertex -> graph of opposite edges
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int a = faces(f, (c + 1) % 3), b = faces(f, (c + 2) % 3);
            links[faces(f, c)][a].push_back(b);
            links[faces(f, c)][b].push_back(a);
        }
    for (const auto& [vertex, graph] : links) {
        std::set<int> seen = {graph.begin()->first};
        std::vector<int> open = {graph.begin()->first};
        while (!open.empty()) {
            const int at = open.back();
            open.pop_back();
            for (int next : graph.at(at))
                if (seen.insert(next).second) open.push_back(next);
        }
        if (seen.size() != graph.size()) return false;
    }
    return true;
}

}  // namespace

double smallest_angle(const Points& vertices, const Eigen::RowVector3i& face) {
    double smallest = 180.0;
    for (int c = 0; c < 3; ++c) {
        const Vec3 corner = vertices.row(face[c]);
        const Vec3 u = vertices.row(face[(c + 1) % 3]).transpose() - corner;
        const Vec3 v = vertices.row(face[(c + 2) % 3]).transpose() - corner;
        smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / M_PI);
    }
    return smallest;
}

double smallest_angle(const TriMesh& mesh) {
    double smallest = 180.0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        smallest = std::min(smallest, smallest_angle(mesh.vertices, mesh.faces.row(f)));
    return smallest;
}

double mean_inner_degree(const TriMesh& mesh) {
    std::vector<int> degree(static_cast<size_t>(mesh.vertices.rows()), 0);
    for (const auto& [a, b] : undirected_edges(mesh.faces)) {
        ++degree[static_cast<size_t>(a)];
        ++degree[static_cast<size_t>(b)];
    }
    for (const auto& edge : border_edges(mesh.faces)) degree[static_cast<size_t>(edge.first)] = 0;
    double sum = 0.0, count = 0.0;
    for (int d : degree)
        if (d > 0) {
            sum += d;
            count += 1.0;
        }
    return sum / std::max(1.0, count);
}

std::vector<std::vector<int>> boundary_loops(const Faces& faces) {
    std::map<int, int> next;
    for (const auto& [from, to] : border_edges(faces))
        if (!next.emplace(from, to).second)
            throw ArgumentError("mesh",
                                "a border passes twice through vertex " + std::to_string(from),
                                "split the surface there");
    std::vector<std::vector<int>> loops;
    while (!next.empty()) {
        loops.emplace_back();
        for (int at = next.begin()->first; next.count(at);) {
            loops.back().push_back(at);
            const int to = next.at(at);
            next.erase(at);
            at = to;
        }
    }
    return loops;
}

Topology topology(const Faces& faces) {
    Topology result;
    std::map<std::pair<int, int>, int> uses;
    for (const auto& [edge, count] : directed_edges(faces)) {
        uses[std::minmax(edge.first, edge.second)] += count;
        if (count > 1) result.oriented = false;
    }
    for (const auto& [edge, count] : uses)
        if (count > 2) result.manifold = false;
    result.manifold = result.manifold && has_single_fans(faces);
    result.components = count_components(faces);
    if (result.manifold && result.oriented)
        result.boundary_loops = static_cast<int>(boundary_loops(faces).size());
    const std::set<int> used(faces.data(), faces.data() + faces.size());
    result.euler_characteristic = static_cast<int>(used.size()) - static_cast<int>(uses.size()) +
                                  static_cast<int>(faces.rows());
    return result;
}

}  // namespace cloth
