#pragma once

#include <array>
#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// Two elements of one mesh that share no vertex: a vertex and a face, or two edges.
struct ElementPair {
    std::array<int, 4> vertex;   ///< the vertex and the face's corners, or the ends of both edges
    std::array<int, 2> element;  ///< indices of vertex and face, or of both edges
    bool edges;                  ///< two edges
};

/// The points of two elements that are closest to each other.
struct ClosestPoints {
    std::array<double, 4> weight;  ///< their difference is the sum of weight x: those of the first
                                   ///< element add up to 1, of the second to -1
    Vec3 offset;                   ///< that difference (m)
    double squared;                ///< its squared length (m^2)
    bool facing;  ///< the elements face each other there: the vertex is above the face, or within
                  ///< 45 degrees of that; the edges cross, seen along the offset
};

/// @param corners  positions of the pair's vertices (m)
ClosestPoints closest_points(bool edges, const std::array<Vec3, 4>& corners);

inline std::array<Vec3, 4> corners_of(const ElementPair& pair, const Points& x) {
    return {x.row(pair.vertex[0]), x.row(pair.vertex[1]), x.row(pair.vertex[2]),
            x.row(pair.vertex[3])};
}

/// Whether one of a pair's vertices is marked (|V|, or empty).
inline bool has_any(const ElementPair& pair, const std::vector<char>& marked) {
    if (marked.empty()) return false;
    const auto is = [&](size_t k) { return marked[static_cast<size_t>(pair.vertex[k])] != 0; };
    return is(0) || is(1) || is(2) || is(3);
}

/// Which elements are whose, so that pairs of faces make each pair of elements once, however many
/// faces share it: every vertex and every edge is owned by one of its faces (Curtis, Tamstorf and
/// Manocha 2008, "Fast collision detection for deformable models using representative-triangles").
class SelfElements {
 public:
    explicit SelfElements(const Garment& garment);

    /// Edges that face f owns, then -1 where there are fewer than three.
    const std::array<int, 3>& edges_of(int f) const { return m_own_edges[static_cast<size_t>(f)]; }

    /// The vertices, likewise.
    const std::array<int, 3>& vertices_of(int f) const {
        return m_own_vertices[static_cast<size_t>(f)];
    }

    const Faces& faces() const { return m_faces; }
    const std::vector<std::array<int, 2>>& edges() const { return m_edges; }

 private:
    Faces m_faces;
    std::vector<std::array<int, 2>> m_edges;
    std::vector<std::array<int, 3>> m_own_vertices,
        m_own_edges;  ///< |F|; at the end -1: fewer than three
};

}  // namespace cloth
