#include "data/body/clearance.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace cloth {

namespace {

constexpr int kRounds = 60;
constexpr double kMargin = 1e-4;  // beyond the clearance, so that the rounds come to an end (m)

template <size_t N, class Push>
void probe(const TriMesh& mesh, const std::array<int, N>& corners, const Push& push, Points& move) {
    Vec3 p = Vec3::Zero();
    for (int corner : corners) p += mesh.vertices.row(corner) / static_cast<double>(N);
    const Vec3 wish = push(p);
    const double length = wish.norm();
    for (int corner : corners)
        if (length > move.row(corner).norm()) move.row(corner) = wish;
}

/// What the vertices have to move by (|V| x 3, m), so that the points of the mesh do as `push`
/// says.
template <class Push>
Points moves_of(const TriMesh& mesh, const std::vector<std::array<int, 2>>& edges,
                const Push& push) {
    Points move = Points::Zero(mesh.vertices.rows(), 3);
    for (int i = 0; i < mesh.vertices.rows(); ++i) probe(mesh, std::array<int, 1>{i}, push, move);
    for (const auto& edge : edges) probe(mesh, edge, push, move);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        probe(mesh, std::array<int, 3>{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, push,
              move);
    return move;
}

/// Vertices move at least by that, and half as much as their neighbours do.
Points spread(const Points& move, const std::vector<std::array<int, 2>>& edges) {
    Points sum = Points::Zero(move.rows(), 3);
    VectorX count = VectorX::Zero(move.rows());
    for (const auto& [a, b] : edges) {
        sum.row(a) += move.row(b);
        sum.row(b) += move.row(a);
        count[a] += 1.0;
        count[b] += 1.0;
    }
    Points result = move;
    for (Eigen::Index i = 0; i < move.rows(); ++i) {
        const Eigen::RowVector3d mean = sum.row(i) / std::max(1.0, count[i]);
        if (mean.norm() > move.row(i).norm()) result.row(i) = mean;
    }
    return result;
}

}  // namespace

double push_out(TriMesh& mesh, const SurfaceDistance& body, double clearance) {
    const std::vector<std::array<int, 2>> edges = undirected_edges(mesh.faces);
    for (int round = 0; round < kRounds; ++round) {
        double smallest = std::numeric_limits<double>::infinity();
        const Points move = moves_of(mesh, edges, [&](const Vec3& p) -> Vec3 {
            const NearestPoint near = body.nearest(p);
            smallest = std::min(smallest, near.distance);
            return std::max(0.0, clearance + kMargin - near.distance) * near.normal;
        });
        if (smallest >= clearance) return smallest;
        mesh.vertices += spread(move, edges);
    }
    return smallest_clearance(mesh, body);
}

bool push_over(TriMesh& mesh, const SurfaceDistance& inner, double gap, double reach) {
    const std::vector<std::array<int, 2>> edges = undirected_edges(mesh.faces);
    for (int round = 0; round < kRounds; ++round) {
        const Points move = moves_of(mesh, edges, [&](const Vec3& p) -> Vec3 {
            const std::optional<NearestPoint> near = inner.nearest_within(reach, p);
            if (!near) return Vec3::Zero();
            const Vec3 offset = p - near->point;
            const double height = offset.dot(near->normal);
            const double beside = (offset - height * near->normal).norm();
            const double missing = gap * (1.0 - beside / reach) - height;
            return missing > 0.0 ? Vec3((missing + kMargin) * near->normal) : Vec3(Vec3::Zero());
        });
        if (move.isZero(0.0)) return true;
        mesh.vertices += spread(move, edges);
    }
    return false;
}

}  // namespace cloth
