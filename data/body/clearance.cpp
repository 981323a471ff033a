#include "data/body/clearance.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace cloth {

namespace {

constexpr int kRounds = 60;
constexpr double kMargin = 1e-4;  // beyond the clearance, so that the rounds come to an end (m)

/// What the vertices have to move by, so that a probe point gets clear of the body.
struct Wishes {
    Points move;
    double smallest = std::numeric_limits<double>::infinity();
};

template <size_t N>
void probe(const TriMesh& mesh, const std::array<int, N>& corners, const SurfaceDistance& body,
           double clearance, Wishes& wishes) {
    Vec3 p = Vec3::Zero();
    for (int corner : corners) p += mesh.vertices.row(corner) / static_cast<double>(N);
    const NearestPoint near = body.nearest(p);
    wishes.smallest = std::min(wishes.smallest, near.distance);
    const double missing = clearance + kMargin - near.distance;
    if (missing <= 0.0) return;
    for (int corner : corners)
        if (missing > wishes.move.row(corner).norm())
            wishes.move.row(corner) = missing * near.normal.transpose();
}

Wishes collect_wishes(const TriMesh& mesh, const std::vector<std::array<int, 2>>& edges,
                      const SurfaceDistance& body, double clearance) {
    Wishes wishes{Points::Zero(mesh.vertices.rows(), 3)};
    for (int i = 0; i < mesh.vertices.rows(); ++i)
        probe(mesh, std::array<int, 1>{i}, body, clearance, wishes);
    for (const auto& edge : edges) probe(mesh, edge, body, clearance, wishes);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        probe(mesh, std::array<int, 3>{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, body,
              clearance, wishes);
    return wishes;
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
        const Wishes wishes = collect_wishes(mesh, edges, body, clearance);
        if (wishes.smallest >= clearance) return wishes.smallest;
        mesh.vertices += spread(wishes.move, edges);
    }
    return smallest_clearance(mesh, body);
}

}  // namespace cloth
