#pragma once

#include <vector>

namespace cloth {

/// Neighbours of every node of an undirected graph, itself left out.
using Graph = std::vector<std::vector<int>>;

/// An elimination order that keeps the Cholesky factor of the graph sparse (approximate minimum
/// degree), sorted so that every subtree of the elimination tree is contiguous.
/// @return position[node] in the order
std::vector<int> elimination_order(const Graph& graph);

/// Structure of the factor: for each column of the order, the rows below the diagonal, ascending.
/// The first of them is the column's parent in the elimination tree.
std::vector<std::vector<int>> factor_structure(const Graph& graph,
                                               const std::vector<int>& position);

}  // namespace cloth
