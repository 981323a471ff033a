#pragma once

#include <vector>

#include "gnn/graph/cloth_graph.h"
#include "gnn/graph/features.h"

namespace cloth {

/// Several garments as one graph without edges between them: a network evaluates all of them at
/// once, as a GPU needs it to be busy, and each gets what it would get alone.
class GraphBatch {
 public:
    /// @param graphs  one or more, built with equal settings; a graph may stand here repeatedly, as
    ///                that of equal garments
    /// @throws ArgumentError if there is none, or if their levels or sampling differ
    explicit GraphBatch(const std::vector<const ClothGraph*>& graphs);

    const ClothGraph& graph() const { return m_graph; }
    size_t size() const { return m_parts.size(); }

    /// The features of all garments, in the order of the graphs.
    /// @param features  one per graph, of one kind of network
    /// @throws ArgumentError if their number or sizes are not those of the graphs
    void gather(const std::vector<const Features*>& features, Features& all) const;

    /// The rows (of |V| rows) that belong to garment k.
    Points rows_of(size_t k, const Points& all) const;

 private:
    /// Where the numbers of a garment begin.
    struct Part {
        int first_vertex = 0, vertices = 0, edges = 0;
        std::vector<int> own_edges, edges_here;  ///< per level: the first one, there and in graph()
        std::vector<int> edge_counts;            ///< per level
    };

    void add_level(const std::vector<const ClothGraph*>& graphs, int level);

    ClothGraph m_graph;
    std::vector<Part> m_parts;
};

}  // namespace cloth
