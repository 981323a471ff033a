#pragma once

#include <array>
#include <vector>

#include "collision/self/self_tangles.h"

namespace cloth {

/// Which parts of a tangled garment are on the wrong side: global intersection analysis (Baraff,
/// Witkin and Kass 2003, "Untangling cloth", section 4), from the tangles of one moment alone.
///
/// Edges that pass through faces an odd number of times cut each connected piece into components;
/// across such an edge the side changes. Of the two sides of a piece, the smaller one is wrong.
/// Where a line of intersection parts nothing, such as a slit, no side is wrong.
class TangledRegions {
 public:
    explicit TangledRegions(const Garment& garment);

    /// @param tangles  of one moment
    /// @param known    |V|, wrong() of a moment before: components without any vertex that was
    /// wrong
    ///                 then are left out; null: none is
    void find(const std::vector<Tangle>& tangles, const std::vector<char>* known = nullptr);

    const std::vector<char>& wrong() const { return m_wrong; }  ///< |V|: 1 on the wrong side
    bool left_out() const { return m_left_out; }  ///< whether the last find() left out any

    bool is_wrong(int vertex) const { return m_wrong[static_cast<size_t>(vertex)] != 0; }

    /// Whether the edge has one end on each side.
    bool is_parted(int edge) const {
        const auto& [p, q] = m_edges[static_cast<size_t>(edge)];
        return is_wrong(p) != is_wrong(q);
    }

 private:
    int root(int vertex);
    void join_uncut();
    void choose_sides();
    void mark_smaller();
    void leave_out(const std::vector<char>& known);

    std::vector<std::array<int, 2>> m_edges;
    VectorX m_area;            ///< |V|, in kg
    std::vector<int> m_piece;  ///< |V|
    bool m_left_out = false;
    std::vector<char> m_cut;                       ///< |E|: an odd number of times
    std::vector<int> m_parent;                     ///< |V|
    std::vector<int> m_side;                       ///< |V|: of roots; -1: not known
    std::vector<int> m_largest;                    ///< |pieces|: root
    std::vector<double> m_component;               ///< |V|: area of roots
    std::vector<std::array<double, 2>> m_sides;    ///< |pieces|: area of each
    std::vector<std::array<int, 2>> m_neighbours;  ///< roots beside each other
    std::vector<char> m_was_wrong;                 ///< |V|: of roots
    std::vector<char> m_wrong;                     ///< |V|
};

}  // namespace cloth
