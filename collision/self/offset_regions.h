#pragma once

#include <array>
#include <vector>

#include "collision/self/self_elements.h"

namespace cloth {

/// Tells which pairs of elements push straight apart. Near a point of a surface, the nearest point
/// of the surface is the foot of a perpendicular: on a face, or on an edge or a vertex from which
/// the neighbouring faces fall away. Closest points of single elements are more: a vertex above the
/// neighbour of a face has one on the face's border, seen at a slant, which would brake cloth that
/// slides. (Offset surfaces as the union of prisms, wedges and sphere sectors: Chen, Ng and Kim,
/// Offset Geometric Contact, 2025.)
class OffsetRegions {
 public:
    explicit OffsetRegions(const Garment& garment);

    /// |F|: third vertex of the face beyond the edge from each corner to the next, -1: none.
    const std::vector<std::array<int, 3>>& beyond_faces() const { return m_beyond_face; }

    /// @param pair    elements that face each other
    /// @param points  theirs that are closest
    /// @param x       |V| x 3 (m)
    bool contain(const ElementPair& pair, const ClosestPoints& points, const Points& x) const {
        return pair.edges ? edges_contain(pair, points, x) : face_contains(pair, points, x);
    }

 private:
    bool edges_contain(const ElementPair& pair, const ClosestPoints& points, const Points& x) const;
    bool face_contains(const ElementPair& pair, const ClosestPoints& points, const Points& x) const;

    Faces m_faces;
    std::vector<std::array<int, 2>> m_beside_edge;  ///< |E|: third vertices of its faces, -1: none
    std::vector<std::array<int, 3>> m_beyond_face;
    std::vector<std::vector<int>> m_neighbours;  ///< |V|: at the other ends of its edges
};

}  // namespace cloth
