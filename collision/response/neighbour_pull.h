#pragma once

#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// Strain limiting around vertices that a correction has moved: neighbours that would be left
/// behind come along, those of these too, and so on.
class NeighbourPull {
 public:
    /// @param most  length of an edge over its length at rest that neighbours follow from, 1 to 2
    NeighbourPull(const Garment& garment, double most);

    /// Brings neighbours so near that no edge is longer than the limit and a thousandth, or than
    /// before where it was longer; those between vertices that stay too far apart may be. Pinned
    /// vertices, and those of `moved`, stay where they are.
    /// @param moved   vertices that were moved, ascending
    /// @param before  |V| x 3 (m): the vertices before that
    /// @param x       |V| x 3 (m), changed
    /// @return        the vertices that came along, ascending
    std::vector<int> follow(const std::vector<int>& moved, const Points& before, Points& x);

 private:
    struct Edge {
        int to;
        double most;  ///< (m)
    };

    std::vector<std::vector<Edge>> m_edges;  ///< |V|: those at each vertex
    std::vector<char> m_fixed;               ///< |V|
    std::vector<char> m_followed;            ///< |V|
};

}  // namespace cloth
