#include "collision/response/neighbour_pull.h"

#include <algorithm>
#include <utility>

#include "data/core/check_range.h"

namespace cloth {

constexpr int most_rounds = 64;     // each reaches one ring farther
constexpr double tolerance = 1e-3;  // of the limit

NeighbourPull::NeighbourPull(const Garment& garment, double most)
    : m_edges(static_cast<size_t>(garment.vertex_count())),
      m_fixed(garment.is_pinned()),
      m_followed(m_fixed.size(), 0) {
    check_range("NeighbourPull.most", most, 1.0, 2.0);
    const Points& rest = garment.rest().vertices;
    for (const auto& [a, b] : garment.edges()) {
        const double length = most * (rest.row(b) - rest.row(a)).norm();
        m_edges[static_cast<size_t>(a)].push_back({b, length});
        m_edges[static_cast<size_t>(b)].push_back({a, length});
    }
}

std::vector<int> NeighbourPull::follow(const std::vector<int>& moved, const Points& before,
                                       Points& x) {
    std::vector<int> held;
    for (const int vertex : moved)
        if (!std::exchange(m_fixed[static_cast<size_t>(vertex)], 1)) held.push_back(vertex);
    std::vector<int> followers, ring = moved, next;
    for (int round = 0; round < most_rounds && !ring.empty(); ++round) {
        next.clear();
        for (const int vertex : ring)
            for (const Edge& edge : m_edges[static_cast<size_t>(vertex)]) {
                const double was = (before.row(edge.to) - before.row(vertex)).norm();
                const double most = std::max(edge.most, was);
                const Vec3 along = x.row(edge.to) - x.row(vertex);
                const double length = along.norm();
                if (!(length > (1.0 + tolerance) * most)) continue;
                const bool leads = !m_fixed[static_cast<size_t>(edge.to)];
                const int follower = leads ? edge.to : vertex;
                if (m_fixed[static_cast<size_t>(follower)]) continue;
                x.row(follower) += (leads ? -1.0 : 1.0) * (1.0 - most / length) * along.transpose();
                next.push_back(follower);
            }
        std::sort(next.begin(), next.end());
        next.erase(std::unique(next.begin(), next.end()), next.end());
        for (const int vertex : next)
            if (!std::exchange(m_followed[static_cast<size_t>(vertex)], 1))
                followers.push_back(vertex);
        ring.swap(next);
    }
    for (const int vertex : held) m_fixed[static_cast<size_t>(vertex)] = 0;
    for (const int vertex : followers) m_followed[static_cast<size_t>(vertex)] = 0;
    std::sort(followers.begin(), followers.end());
    return followers;
}

}  // namespace cloth
