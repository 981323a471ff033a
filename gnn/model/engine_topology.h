#pragma once

#include <cstdint>
#include <vector>

#include "gnn/graph/cloth_graph.h"

namespace cloth {

/// Edge rows of one message step, sorted by receiver.
struct EdgeTable {
    std::vector<int> edges;               ///< edge numbers; empty: all, row r is edge r
    std::vector<int> receivers, senders;  ///< vertices
    std::vector<int> first_row;           ///< per group of vertices, and one past the last
};

/// A garment's graph cut into groups of neighbouring vertices. Constant per garment.
struct EngineTopology {
    static constexpr int group_size = 96;  ///< vertices; small enough to share out evenly

    EngineTopology(const ClothGraph& graph, bool sampled);

    int first_vertex(int group) const;
    const EdgeTable& table(size_t step) const { return tables[tables.size() == 1 ? 0 : step]; }
    size_t bytes() const;

    std::uint64_t graph_id;
    int vertices, edges, groups;
    std::vector<int> first_edge;  ///< per group, and one past the last
    int most_edges = 0;           ///< of any group in any step
    std::vector<EdgeTable> tables;
};

}  // namespace cloth
