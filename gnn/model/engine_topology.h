#pragma once

#include <cstdint>
#include <vector>

#include "gnn/graph/cloth_graph.h"
#include "gnn/model/model_config.h"

namespace cloth {

/// Edge rows of one level in one message step, sorted by receiver. Rows of products count the nodes
/// of the level; on level 0 these are the vertices.
struct EdgeTable {
    int first_edge = 0;                   ///< row r is edge first_edge + r, without a list
    std::vector<int> edges;               ///< edge numbers; empty: no list
    std::vector<int> receivers, senders;  ///< receivers' vertices, and rows of senders' products
    std::vector<int> receiver_rows;       ///< of receivers' products; empty: as receivers
    std::vector<int> first_row;           ///< per group of vertices, and one past the last

    size_t bytes() const;
};

/// The vertices of a level by groups.
struct LevelNodes {
    int count = 0;
    std::vector<int> vertices;    ///< ascending; empty on level 0: all
    std::vector<int> first_node;  ///< per group, and one past the last
    std::vector<int> first_edge;  ///< the same for the edges of the level
};

/// A garment's graph cut into groups of neighbouring vertices. Constant per garment.
struct EngineTopology {
    static constexpr int group_size = 96;  ///< vertices; small enough to share out evenly

    /// @param graph  with the levels and the schedules that the configuration asks for
    EngineTopology(const ClothGraph& graph, const ModelConfig& config);

    int first_vertex(int group) const;
    /// Of the level that stands at `slot` in ModelConfig::levels(step).
    const EdgeTable& table(size_t step, size_t slot) const { return tables[table_of[step][slot]]; }
    size_t bytes() const;

    std::uint64_t graph_id;
    int vertices, edges, groups;
    std::vector<LevelNodes> levels;  ///< 0 is the mesh
    std::vector<int> deepest_level;  ///< |V|: coarsest level with the vertex; no coarse ones: empty
    int most_edges = 0;              ///< of any group on any level
    std::vector<EdgeTable> tables;
    std::vector<std::vector<size_t>> table_of;  ///< per step and slot

 private:
    void add_mesh(const ClothGraph& graph);
    void add_level(const CoarseLevel& level);
    void add_table(const ClothGraph& graph, int level, const std::vector<int>* sampled);
};

}  // namespace cloth
