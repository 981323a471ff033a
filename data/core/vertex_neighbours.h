#pragma once

#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// |V|: vertices at the other ends of each one's edges, in the order of the edges.
inline std::vector<std::vector<int>> vertex_neighbours(const Garment& garment) {
    std::vector<std::vector<int>> neighbours(static_cast<size_t>(garment.vertex_count()));
    for (const auto& [a, b] : garment.edges()) {
        neighbours[static_cast<size_t>(a)].push_back(b);
        neighbours[static_cast<size_t>(b)].push_back(a);
    }
    return neighbours;
}

}  // namespace cloth
