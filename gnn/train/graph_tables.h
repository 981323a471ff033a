#pragma once

#include <memory>
#include <vector>

#include "gnn/graph/cloth_graph.h"
#include "gnn/model/model_config.h"
#include "gnn/train/message_op.h"

namespace cloth {

/// A garment's graph as message tables, on the device of the network. Constant per garment.
///
/// A step works on the nodes of its levels alone: products have a row per node of the edges' level,
/// sums a row per node of the step's first level.
struct GraphTables {
    struct Level {
        int nodes = 0, edges = 0;                    ///< numbers
        int first_edge = 0;                          ///< in the order of ClothGraph
        std::vector<int> node_of;                    ///< |V|: row, -1: none; level 0: empty
        torch::Tensor vertices;                      ///< int64 (nodes); level 0: undefined
        std::shared_ptr<const MessageTable> update;  ///< of the nodes
        /// Of some vertices.
        std::vector<int> rows_of(std::vector<int> of) const;
    };

    /// @param graph  with the levels and the schedules that the configuration asks for
    GraphTables(const ClothGraph& graph, const ModelConfig& config, torch::Device device);

    /// Several garments as one graph without edges between them. Its levels have no `first_edge`:
    /// edges of a level stand one garment behind the other.
    /// @param parts  of one configuration
    GraphTables(const std::vector<std::shared_ptr<const GraphTables>>& parts,
                const ModelConfig& config, torch::Device device);

    const Level& level(int number) const { return levels[static_cast<size_t>(number)]; }
    /// Of the level that stands at `slot` in ModelConfig::levels(step).
    const MessageTable& edge_table(int step, size_t slot) const {
        return *edge_tables[static_cast<size_t>(step)][slot];
    }

    std::vector<Level> levels;  ///< 0 is the mesh
    std::vector<std::vector<std::shared_ptr<const MessageTable>>> edge_tables;

 private:
    void join_levels(const std::vector<std::shared_ptr<const GraphTables>>& parts,
                     RowShifts& row_shifts);
    void add_level(int vertices, std::vector<int> nodes, const std::vector<int>& first_edge,
                   torch::Device device);
};

/// Rows of a matrix; all of them where `rows` is undefined.
torch::Tensor rows_at(const torch::Tensor& matrix, const torch::Tensor& rows);

}  // namespace cloth
