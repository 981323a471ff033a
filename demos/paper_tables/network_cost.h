#pragma once

#include <string>
#include <vector>

#include "demos/compare/comparison_scene.h"

namespace cloth {

/// What a network costs by itself, in the engine.
struct NetworkCost {
    double memory_mb;  ///< weights, tables and workspace (MB of 1e6 bytes), as the engine counts
    double ms;         ///< of one evaluation, the median of several rounds
};

/// Of several networks, which are evaluated in turn: what slows the machine down for a while slows
/// all of them down.
/// @param files    of the weights
/// @param start    the state that they are evaluated at
/// @param threads  0: as many as OpenMP gives
/// @throws LoadError if weights cannot be used
std::vector<NetworkCost> network_costs(const std::vector<std::string>& files,
                                       const ComparisonScene& scene, const ClothState& start,
                                       int threads);

}  // namespace cloth
