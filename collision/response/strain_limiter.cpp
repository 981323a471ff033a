#include "collision/response/strain_limiter.h"

#include <algorithm>

namespace cloth {

constexpr char rings = 2;
constexpr Eigen::Index enough_edges = 4000;  // to be worth waking threads for

StrainLimiter::StrainLimiter(const Garment& garment, double growth)
    : m_growth(growth),
      m_edges(garment.edges()),
      m_rest(static_cast<Eigen::Index>(m_edges.size())),
      m_limit(m_rest.size()),
      m_region(static_cast<size_t>(garment.vertex_count()), 0) {
    const Points& rest = garment.rest().vertices;
    for (Eigen::Index e = 0; e < m_rest.size(); ++e) {
        const auto& [a, b] = m_edges[static_cast<size_t>(e)];
        m_rest[e] = (rest.row(b) - rest.row(a)).norm();
    }
}

void StrainLimiter::begin_frame(const Points& x) {
#pragma omp parallel for if (m_limit.size() >= enough_edges)
    for (Eigen::Index e = 0; e < m_limit.size(); ++e) {
        const auto& [a, b] = m_edges[static_cast<size_t>(e)];
        m_limit[e] = (1.0 + m_growth) * std::max(m_rest[e], (x.row(b) - x.row(a)).norm());
    }
}

void StrainLimiter::add_planes(const Points& x, PlanePush& push) {
    std::fill(m_region.begin(), m_region.end(), 0);
    push.mark_vertices(m_region);
    for (char ring = 1; ring <= rings; ++ring)
        for (const auto& [a, b] : m_edges) {
            char& first = m_region[static_cast<size_t>(a)];
            char& second = m_region[static_cast<size_t>(b)];
            if (first == ring && second == 0) second = static_cast<char>(ring + 1);
            if (second == ring && first == 0) first = static_cast<char>(ring + 1);
        }
    for (size_t e = 0; e < m_edges.size(); ++e) {
        const auto& [a, b] = m_edges[e];
        if (!m_region[static_cast<size_t>(a)] && !m_region[static_cast<size_t>(b)]) continue;
        const Vec3 along = x.row(b) - x.row(a);
        const double length = along.norm();
        if (length > 0.0)
            push.add({a, b, b}, {1.0, -1.0, 0.0}, along / length,
                     -m_limit[static_cast<Eigen::Index>(e)]);
    }
}

double StrainLimiter::excess(const Points& x) const {
    double worst = 0.0;
#pragma omp parallel for reduction(max : worst) if (m_limit.size() >= enough_edges)
    for (Eigen::Index e = 0; e < m_limit.size(); ++e) {
        const auto& [a, b] = m_edges[static_cast<size_t>(e)];
        worst = std::max(worst, (x.row(b) - x.row(a)).norm() - m_limit[e]);
    }
    return worst;
}

}  // namespace cloth
