#include "collision/self/element_bounds.h"

#include <algorithm>

namespace cloth {
namespace {

constexpr double rounding = 1e-6;  // of single precision, with room for what is done with it

Eigen::Array4f lanes(const Vec3& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0f};
}

}  // namespace

void ElementBounds::update(const SelfElements& elements, const Points& x, const Points& motion) {
    if (x.rows() == 0) return;
    const Vec3 origin = x.row(0);
    m_points.resize(static_cast<size_t>(x.rows()));
    double size = 0.0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Vec3 at = x.row(i).transpose() - origin;
        size = std::max(size, at.cwiseAbs().maxCoeff());
        m_points[static_cast<size_t>(i)] = lanes(at);
    }
    m_rounding = static_cast<float>(rounding * size + 1e-12);
    const Faces& faces = elements.faces();
    m_discs.resize(static_cast<size_t>(faces.rows()));
    m_motions.resize(m_discs.size());
    for (size_t f = 0; f < m_discs.size(); ++f) {
        const auto corner = faces.row(static_cast<Eigen::Index>(f));
        const Vec3 a = x.row(corner[0]), b = x.row(corner[1]), c = x.row(corner[2]);
        const Vec3 centre = (a + b + c) / 3.0;
        const Vec3 mean =
            (motion.row(corner[0]) + motion.row(corner[1]) + motion.row(corner[2])) / 3.0;
        double radius = 0.0, motion_radius = 0.0;
        for (int k = 0; k < 3; ++k) {
            radius = std::max(radius, (x.row(corner[k]).transpose() - centre).squaredNorm());
            motion_radius =
                std::max(motion_radius, (motion.row(corner[k]).transpose() - mean).squaredNorm());
        }
        m_discs[f] = {lanes(centre - origin), lanes((b - a).cross(c - a).normalized()),
                      static_cast<float>((1.0 + rounding) * std::sqrt(radius))};
        // rounded by a millionth of the motion, whatever its direction
        m_motions[f] = {lanes(mean),
                        static_cast<float>((1.0 + rounding) * std::sqrt(motion_radius) +
                                           rounding * mean.norm())};
    }
    m_rods.resize(elements.edges().size());
    for (size_t e = 0; e < m_rods.size(); ++e) {
        const auto& [a, b] = elements.edges()[e];
        const Vec3 half = 0.5 * (x.row(b) - x.row(a)).transpose();
        m_rods[e] = {lanes(x.row(a).transpose() + half - origin), lanes(half),
                     static_cast<float>((1.0 + rounding) * half.norm())};
    }
}

}  // namespace cloth
