#include "collision/self/element_bounds.h"

#include <algorithm>

namespace cloth {

constexpr double rounding = 1e-9;  // of a radius

void ElementBounds::update(const SelfElements& elements, const Points& x, const Points& motion) {
    const Faces& faces = elements.faces();
    m_faces.resize(static_cast<size_t>(faces.rows()));
    for (size_t f = 0; f < m_faces.size(); ++f) {
        const auto corner = faces.row(static_cast<Eigen::Index>(f));
        Disc& disc = m_faces[f];
        const Vec3 a = x.row(corner[0]), b = x.row(corner[1]), c = x.row(corner[2]);
        disc.centre = (a + b + c) / 3.0;
        disc.normal = (b - a).cross(c - a).normalized();
        disc.motion = (motion.row(corner[0]) + motion.row(corner[1]) + motion.row(corner[2])) / 3.0;
        double radius = 0.0, motion_radius = 0.0;
        for (int k = 0; k < 3; ++k) {
            radius = std::max(radius, (x.row(corner[k]).transpose() - disc.centre).squaredNorm());
            motion_radius = std::max(
                motion_radius, (motion.row(corner[k]).transpose() - disc.motion).squaredNorm());
        }
        disc.radius = (1.0 + rounding) * std::sqrt(radius) + 1e-12;
        disc.motion_radius = (1.0 + rounding) * std::sqrt(motion_radius);
    }
    m_edges.resize(elements.edges().size());
    for (size_t e = 0; e < m_edges.size(); ++e) {
        const auto& [a, b] = elements.edges()[e];
        m_edges[e].middle = 0.5 * (x.row(a) + x.row(b));
        m_edges[e].half = 0.5 * (x.row(b) - x.row(a));
        m_edges[e].length = m_edges[e].half.norm();
    }
}

}  // namespace cloth
