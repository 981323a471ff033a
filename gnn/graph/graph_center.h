#pragma once

#include <vector>

namespace cloth {

/// An undirected graph: each node's neighbours, ascending.
using Adjacency = std::vector<std::vector<int>>;

/// Numbers of edges to the nearest of some nodes.
struct HopDistances {
    std::vector<int> hops;    ///< |V|; -1: no path
    std::vector<int> source;  ///< |V|: which of the nodes it is; -1: none
};

/// @param sources  different nodes
HopDistances hop_distances(const Adjacency& graph, const std::vector<int>& sources);

/// The centre of each connected component that has an edge: the node whose farthest node is
/// nearest, of equals the one of lowest number. In the order of the components' lowest nodes.
std::vector<int> component_centers(const Adjacency& graph);

}  // namespace cloth
