#include "collision/response/plane_push.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth {

constexpr double relaxation = 1.5;       // of the Jacobi steps; they converge below 2
constexpr double good_enough = 1e-6;     // m: lifts below this end the sweeps
constexpr double planes_per_vertex = 8;  // reserved
constexpr double rounding = 1e-9;        // m: that idle planes keep clear

PlanePush::PlanePush(VectorX inverse_masses)
    : m_inverse_masses(std::move(inverse_masses)),
      m_shares(static_cast<size_t>(m_inverse_masses.size()), 0),
      m_before(Points::Zero(m_inverse_masses.size(), 3)),
      m_last(m_before) {
    m_planes.reserve(static_cast<size_t>(planes_per_vertex) * m_shares.size());
    m_touched.reserve(m_shares.size());
}

void PlanePush::add(const std::array<int, 3>& vertex, const std::array<double, 3>& weight,
                    const Vec3& normal, double height) {
    m_planes.push_back({{vertex[0], vertex[1], vertex[2], vertex[2]},
                        {weight[0], weight[1], weight[2], 0.0},
                        3,
                        normal,
                        height});
}

void PlanePush::add_pair(const std::array<int, 4>& vertex, const std::array<double, 4>& weight,
                         const Vec3& normal, double height) {
    m_planes.push_back({vertex, weight, 4, normal, height});
}

void PlanePush::mark_vertices(std::vector<char>& marks) const {
    for (const Plane& plane : m_planes)
        for (size_t k = 0; k < plane.count; ++k)
            if (plane.weight[k] != 0.0) marks[static_cast<size_t>(plane.vertex[k])] = 1;
}

/// How far the plane's point is below it (m), negative above.
double PlanePush::missing(const Plane& plane, const Points& x) const {
    double height = 0.0;
    for (size_t k = 0; k < plane.count; ++k)
        if (plane.weight[k] != 0.0)
            height += plane.weight[k] * x.row(plane.vertex[k]).dot(plane.normal);
    return plane.height - height;
}

/// Returns the largest lift that a plane asks for (m).
double PlanePush::share_out(const Points& x) {
    m_touched.clear();
    double deepest = 0.0;
    for (const Plane& plane : m_planes) {
        deepest = std::max(deepest, missing(plane, x));
        for (size_t k = 0; k < plane.count; ++k) {
            if (plane.weight[k] == 0.0) continue;
            const int i = plane.vertex[k];
            if (m_shares[static_cast<size_t>(i)]++ == 0) {
                m_touched.push_back(i);
                m_before.row(i) = m_last.row(i) = x.row(i);
            }
        }
    }
    for (Plane& plane : m_planes)
        for (size_t k = 0; k < plane.count; ++k) {
            plane.mobility += plane.weight[k] * plane.weight[k] *
                              m_inverse_masses[plane.vertex[k]] *
                              m_shares[static_cast<size_t>(plane.vertex[k])];
            plane.reach += std::abs(plane.weight[k]);
        }
    m_path = 0.0;
    return deepest;
}

/// How far the vertex that moved farthest did since the last call (m).
double PlanePush::farthest_motion(const Points& x) {
    double squared = 0.0;
    for (const int i : m_touched) {
        squared = std::max(squared, (x.row(i) - m_last.row(i)).squaredNorm());
        m_last.row(i) = x.row(i);
    }
    return std::sqrt(squared);
}

/// Returns the largest lift (m). A plane that lifts nothing is not looked at again before its
/// point may have come down to it: most planes keep lengths of edges that nothing lengthens.
double PlanePush::sweep(Points& x) {
    double largest = 0.0;
    for (Plane& plane : m_planes) {
        if (m_path < plane.idle_until || !(plane.mobility > 0.0)) continue;
        const double below = missing(plane, x);
        const double lift = relaxation * below;
        plane.change = std::max(lift / plane.mobility, -plane.multiplier);
        plane.multiplier += plane.change;
        largest = std::max(largest, std::abs(plane.change) * plane.mobility);
        if (plane.multiplier == 0.0 && plane.change == 0.0)
            plane.idle_until = m_path - (below + rounding) / plane.reach;
    }
    for (const Plane& plane : m_planes) {
        if (plane.change == 0.0) continue;
        for (size_t k = 0; k < plane.count; ++k)
            x.row(plane.vertex[k]) += plane.weight[k] * m_inverse_masses[plane.vertex[k]] *
                                      plane.change * plane.normal.transpose();
    }
    m_path += farthest_motion(x);
    return largest;
}

void PlanePush::limit(double allowed, Points& x) const {
    for (const int i : m_touched) {
        const Vec3 motion = x.row(i) - m_before.row(i);
        const double length = motion.norm();
        if (length > allowed) x.row(i) = m_before.row(i) + allowed / length * motion.transpose();
    }
}

void PlanePush::solve(int sweeps, double most, Points& x) {
    const double deepest = share_out(x);
    for (int k = 0; k < sweeps; ++k)
        if (sweep(x) < good_enough) break;
    limit(most * deepest, x);
    for (const int i : m_touched) m_shares[static_cast<size_t>(i)] = 0;
}

}  // namespace cloth
