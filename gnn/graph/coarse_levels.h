#pragma once

#include <string>
#include <vector>

#include "gnn/graph/graph_center.h"

namespace cloth {

/// How a coarser graph is made of a graph. Both keep every other ring around a component's centre.
///
/// - **hood** (Grigorev et al., *HOOD: Hierarchical Graphs for Generalized Modelling of Clothing
///   Dynamics*, CVPR 2023): nodes of even distance from the mesh's centre. Edges lead over a node
///   of odd distance to the next ring. Neighbours within a ring, and those around a node without a
///   next ring, get an edge where two edges do not join them already.
/// - **bistride** (Cao et al., *Efficient Learning of Mesh-Based Physical Simulation with
///   Bi-Stride Multi-Scale Graph Neural Network*, ICML 2023): the rings of even or of odd distance,
///   whichever are fewer nodes. Edges join what is one or two edges apart. Each level has a centre
///   of its own; the paper's is the node nearest to the mean place.
enum class Pooling { none, hood, bistride };

/// "none", "hood" or "bistride".
const std::string& pooling_name(Pooling pooling);
/// @throws ArgumentError if there is no such pooling
Pooling pooling_named(const std::string& name);

/// Ever coarser graphs of the same nodes; those that a level leaves out have no neighbours in it. A
/// component stays connected. It leaves out the levels for which it is too small, which are those
/// that would have one node of it: isolated nodes and single triangles are in none.
/// @param levels  0 or more; their number, also where the last ones are empty
std::vector<Adjacency> build_coarse_levels(const Adjacency& mesh, Pooling pooling, int levels);

}  // namespace cloth
