#include "collision/self/self_proximity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/geometry/gather_in_order.h"
#include "data/core/garment_pieces.h"

namespace cloth {
namespace {

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

double longest_edge(const Garment& garment) {
    const Points& rest = garment.rest().vertices;
    double squared = 0.0;
    for (const auto& [a, b] : garment.edges())
        squared = std::max(squared, (rest.row(a) - rest.row(b)).squaredNorm());
    return std::sqrt(squared);
}

}  // namespace

SelfProximity::SelfProximity(const Garment& garment, double thickness, FaceParts parts)
    : m_groups(garment, ElementGroups::Which::facing),
      m_regions(garment),
      m_rest(garment.rest().vertices),
      m_piece(garment_pieces(garment)),
      m_parts_of_faces(std::move(parts)),
      m_thickness(thickness),
      m_rest_reach(thickness + 2.0 * longest_edge(garment)) {
}

bool SelfProximity::near_at_rest(const ElementPair& elements) const {
    if (m_piece[static_cast<size_t>(elements.vertex[0])] !=
        m_piece[static_cast<size_t>(elements.vertex[3])])
        return false;
    const auto between = m_rest.row(elements.vertex[0]) - m_rest.row(elements.vertex[3]);
    if (between.squaredNorm() > m_rest_reach * m_rest_reach) return false;
    return closest_points(elements.edges, corners_of(elements, m_rest)).squared <
           m_thickness * m_thickness;
}

bool SelfProximity::is_near(const ElementPair& elements, const Points& x, const Points& motion,
                            double reach, SelfPair& pair) const {
    const std::array<Vec3, 4> corners = corners_of(elements, x);
    const ClosestPoints points = closest_points(elements.edges, corners);
    if (!points.facing || !(points.squared > 0.0)) return false;
    const Vec3 shift = combine(elements, points.weight, motion);
    if (!(least_squared(points.offset, shift) <= reach * reach)) return false;
    if (!m_regions.contain(elements, points, x) || near_at_rest(elements)) return false;
    const double distance = std::sqrt(points.squared);
    pair = {elements, points.weight, points.offset / distance, distance};
    return true;
}

void SelfProximity::find(const Points& x, const Points& motion, double reach, int threads) {
    m_groups.find(x, motion, reach, threads);
    const auto find = [&](int k, std::vector<SelfPair>& out) {
        m_groups.visit(k, [&](const ElementPair& elements, int f, int g) {
            SelfPair pair;
            if (!m_parts_of_faces.same(f, g) && is_near(elements, x, motion, reach, pair))
                out.push_back(pair);
        });
    };
    gather_each_in_order(m_groups.found(), m_groups.worthwhile(threads), m_parts, m_pairs, find,
                         ElementGroups::pairs_at_once);
    sort_pairs();
}

/// Whoever goes through the pairs one after the other should not depend on how faces are grouped.
void SelfProximity::sort_pairs() {
    m_order.clear();
    for (const SelfPair& pair : m_pairs) {  // vertices and faces first, then by the elements
        const std::uint64_t edges = pair.elements.edges;
        const auto first = static_cast<std::uint64_t>(pair.elements.element[0]);
        const auto second = static_cast<std::uint64_t>(pair.elements.element[1]);
        m_order.push_back({edges << 62 | first << 31 | second, m_order.size()});
    }
    std::sort(m_order.begin(), m_order.end());
    m_sorted.clear();
    for (const auto& place : m_order) m_sorted.push_back(m_pairs[place[1]]);
    m_pairs.swap(m_sorted);
}

}  // namespace cloth
