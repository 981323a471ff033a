#include "collision/self_proximity.h"

#include <algorithm>
#include <cmath>

#include "collision/gather_in_order.h"
#include "data/garment_pieces.h"

namespace cloth {
namespace {

constexpr int faces_per_part = 2048;  // pairs of faces that a thread takes at once

/// Least squared distance from the origin of the points offset + s shift, s in 0 to 1.
double least_squared(const Vec3& offset, const Vec3& shift) {
    const double length = shift.squaredNorm();
    if (!(length > 0.0)) return offset.squaredNorm();
    const double s = std::clamp(-offset.dot(shift) / length, 0.0, 1.0);
    return (offset + s * shift).squaredNorm();
}

Vec3 combine(const ElementPair& elements, const std::array<double, 4>& weight, const Points& rows) {
    Vec3 sum = Vec3::Zero();
    for (size_t k = 0; k < 4; ++k) sum += weight[k] * rows.row(elements.vertex[k]).transpose();
    return sum;
}

/// Whether spheres around the elements, drawn along their motion, stay apart: most candidates end
/// here.
bool clearly_apart(const ElementPair& elements, const std::array<Vec3, 4>& x, const Points& motion,
                   double reach) {
    const size_t first = elements.edges ? 2 : 1;
    const Vec3 here = elements.edges ? Vec3(0.5 * (x[0] + x[1])) : x[0];
    const Vec3 there = elements.edges ? Vec3(0.5 * (x[2] + x[3])) : x[1];
    const double size =
        (elements.edges ? (x[1] - here).norm() : 0.0) +
        std::sqrt(std::max((x[2] - there).squaredNorm(), (x[3] - there).squaredNorm()));
    double most = 0.0;
    for (size_t a = 0; a < first; ++a)
        for (size_t b = first; b < 4; ++b)
            most = std::max(
                most,
                (motion.row(elements.vertex[a]) - motion.row(elements.vertex[b])).squaredNorm());
    const double far = size + reach + std::sqrt(most);
    return (here - there).squaredNorm() > far * far;
}

}  // namespace

SelfProximity::SelfProximity(const Garment& garment, double thickness)
    : m_elements(garment),
      m_faces(garment.rest().vertices, garment.rest().faces),
      m_rest(garment.rest().vertices),
      m_piece(garment_pieces(garment)),
      m_thickness(thickness) {
}

bool SelfProximity::near_at_rest(const ElementPair& elements) const {
    if (m_piece[static_cast<size_t>(elements.vertex[0])] !=
        m_piece[static_cast<size_t>(elements.vertex[3])])
        return false;
    return closest_points(elements.edges, corners_of(elements, m_rest)).squared <
           m_thickness * m_thickness;
}

bool SelfProximity::is_near(const ElementPair& elements, const Points& x, const Points& motion,
                            double reach, SelfPair& pair) const {
    const std::array<Vec3, 4> corners = corners_of(elements, x);
    if (clearly_apart(elements, corners, motion, reach)) return false;
    const ClosestPoints points = closest_points(elements.edges, corners);
    if (!points.facing || !(points.squared > 0.0)) return false;
    const Vec3 shift = combine(elements, points.weight, motion);
    if (!(least_squared(points.offset, shift) <= reach * reach)) return false;
    if (near_at_rest(elements)) return false;
    const double distance = std::sqrt(points.squared);
    pair = {elements, points.weight, points.offset / distance, distance};
    return true;
}

void SelfProximity::find(const Points& x, const Points& motion, double reach, int threads) {
    m_faces.find(x, motion, reach, threads);
    const auto& faces = m_faces.found();
    const int count = static_cast<int>(faces.size());
    const auto find_part = [&](int part, std::vector<SelfPair>& out) {
        const int end = std::min(count, (part + 1) * faces_per_part);
        for (int k = part * faces_per_part; k < end; ++k) {
            const auto& [f, g] = faces[static_cast<size_t>(k)];
            m_elements.visit(f, g, [&](const ElementPair& elements) {
                SelfPair pair;
                if (is_near(elements, x, motion, reach, pair)) out.push_back(pair);
            });
        }
    };
    gather_in_order((count + faces_per_part - 1) / faces_per_part, threads, m_parts, m_pairs,
                    find_part);
}

}  // namespace cloth
