#include "collision/self/offset_regions.h"

#include <algorithm>
#include <map>

#include "data/core/vertex_neighbours.h"

namespace cloth {
namespace {

// Sine of the slant that edges may have: where they cross on flat layers it is zero but for
// rounding and slight waves.
constexpr double largest_slant = 0.1;

/// Part of `point - a` that is perpendicular to the edge from a to b.
Vec3 away_from_edge(const Vec3& a, const Vec3& b, const Vec3& point) {
    const Vec3 along = b - a, to = point - a;
    const double squared = along.squaredNorm();
    return squared > 0.0 ? Vec3(to - (to.dot(along) / squared) * along) : to;
}

}  // namespace

OffsetRegions::OffsetRegions(const Garment& garment)
    : m_faces(garment.rest().faces),
      m_beside_edge(garment.edges().size(), {-1, -1}),
      m_beyond_face(static_cast<size_t>(garment.face_count()), {-1, -1, -1}),
      m_neighbours(vertex_neighbours(garment)) {
    std::map<std::array<int, 2>, size_t> index;
    for (size_t e = 0; e < garment.edges().size(); ++e) {
        const auto [a, b] = garment.edges()[e];
        index[{std::min(a, b), std::max(a, b)}] = e;
    }
    const auto edge_of = [&](Eigen::Index face, int corner) -> std::array<int, 2>& {
        const int a = m_faces(face, corner), b = m_faces(face, (corner + 1) % 3);
        return m_beside_edge[index.at({std::min(a, b), std::max(a, b)})];
    };
    for (Eigen::Index face = 0; face < m_faces.rows(); ++face)
        for (int corner = 0; corner < 3; ++corner) {
            std::array<int, 2>& beside = edge_of(face, corner);
            beside[beside[0] < 0 ? 0 : 1] = m_faces(face, (corner + 2) % 3);
        }
    for (Eigen::Index face = 0; face < m_faces.rows(); ++face)
        for (int corner = 0; corner < 3; ++corner) {
            const std::array<int, 2>& beside = edge_of(face, corner);
            m_beyond_face[static_cast<size_t>(face)][static_cast<size_t>(corner)] =
                beside[0] == m_faces(face, (corner + 2) % 3) ? beside[1] : beside[0];
        }
}

bool OffsetRegions::edges_contain(const ElementPair& pair, const ClosestPoints& points,
                                  const Points& x) const {
    const auto slants = [&](size_t side, const Vec3& to_other) {
        const Vec3 a = x.row(pair.vertex[2 * side]), b = x.row(pair.vertex[2 * side + 1]);
        const std::array<int, 2>& beside = m_beside_edge[static_cast<size_t>(pair.element[side])];
        return std::any_of(beside.begin(), beside.end(), [&](int vertex) {
            if (vertex < 0) return false;
            const Vec3 into = away_from_edge(a, b, x.row(vertex));
            const double nearer = into.dot(to_other);
            return nearer > 0.0 && nearer * nearer > largest_slant * largest_slant *
                                                         into.squaredNorm() * points.squared;
        });
    };
    return !slants(0, -points.offset) && !slants(1, points.offset);
}

bool OffsetRegions::face_contains(const ElementPair& pair, const ClosestPoints& points,
                                  const Points& x) const {
    const auto on = [&](int corner) {
        return points.weight[static_cast<size_t>(corner) + 1] < 0.0;
    };
    const int corners = int{on(0)} + int{on(1)} + int{on(2)};
    if (corners == 3) return true;
    const int face = pair.element[1];
    if (corners == 2) {
        const int from = !on(0) ? 1 : !on(1) ? 2 : 0;
        const int beyond = m_beyond_face[static_cast<size_t>(face)][static_cast<size_t>(from)];
        if (beyond < 0) return true;
        const Vec3 a = x.row(m_faces(face, from)), b = x.row(m_faces(face, (from + 1) % 3));
        return !(away_from_edge(a, b, x.row(beyond)).dot(points.offset) > 0.0);
    }
    const int corner = m_faces(face, on(0) ? 0 : on(1) ? 1 : 2);
    const std::vector<int>& around = m_neighbours[static_cast<size_t>(corner)];
    return std::none_of(around.begin(), around.end(), [&](int other) {
        return (x.row(other) - x.row(corner)).dot(points.offset.transpose()) > 0.0;
    });
}

}  // namespace cloth
