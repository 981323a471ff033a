#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision/self/element_groups.h"
#include "collision/self/face_parts.h"
#include "collision/self/offset_regions.h"

namespace cloth {

/// Two elements of a garment that are near each other, as a plane between them:
///
///     distance(x) = normal . sum of weight x,
///
/// linear in x with the weights and the normal of the moment at which they were found. Positive is
/// the side on which the first element was then.
struct SelfPair {
    ElementPair elements;
    std::array<double, 4> weight;  ///< see ClosestPoints
    Vec3 normal;                   ///< unit, from the second element to the first
    double distance;               ///< when found (m)

    double distance_at(const Points& x) const {
        double height = 0.0;
        for (size_t k = 0; k < 4; ++k)
            height += weight[k] * x.row(elements.vertex[k]).dot(normal.transpose());
        return height;
    }
};

/// Parts of one garment that are near each other, or are about to be.
///
///     SelfProximity proximity(garment, 4e-3);
///     proximity.find(state.x, dt * state.v, 4e-3 + slack, threads);
///     for (const SelfPair& pair : proximity.pairs()) { ... }
///
/// Only elements that face each other make a pair: a vertex above a face, edges that cross; and
/// only where no neighbour of one of them is nearer, see OffsetRegions. What is next to each other
/// within the cloth does not, nor do elements of one connected piece that are nearer than the
/// thickness in the rest pose, or elements that touch exactly: they have no sides.
class SelfProximity {
 public:
    /// @param thickness  (m)
    /// @param parts      faces of one part make no pairs
    SelfProximity(const Garment& garment, double thickness, FaceParts parts = {});

    /// Replaces pairs() by those whose closest points at x (|V| x 3, m), fixed to their elements,
    /// come within `reach` (m) of each other anywhere on the way to x + motion (|V| x 3, m). The
    /// order depends on the arguments alone. After the first frames nothing is allocated.
    /// @param threads  0: as many as OpenMP gives
    void find(const Points& x, const Points& motion, double reach, int threads);

    const std::vector<SelfPair>& pairs() const { return m_pairs; }

 private:
    bool is_near(const ElementPair& elements, const Points& x, const Points& motion, double reach,
                 SelfPair& pair) const;
    bool near_at_rest(const ElementPair& elements) const;
    void sort_pairs();

    ElementGroups m_groups;
    OffsetRegions m_regions;
    Points m_rest;             ///< |V| x 3 (m)
    std::vector<int> m_piece;  ///< |V|: connected piece
    FaceParts m_parts_of_faces;
    double m_thickness;
    double m_rest_reach;  ///< vertices farther apart are of elements that are not near at rest (m)
    std::vector<SelfPair> m_pairs, m_sorted;
    std::vector<std::array<std::uint64_t, 2>> m_order;  ///< whose pair, and its index
    std::vector<std::vector<SelfPair>> m_parts;
};

}  // namespace cloth
