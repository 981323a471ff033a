#pragma once

#include <string>

#include "demos/compare/comparison_scene.h"

namespace cloth {

/// What a network costs by itself, in the engine.
struct NetworkCost {
    double memory_mb;  ///< weights, tables and workspace (MB of 1e6 bytes), as the engine counts
    double ms;         ///< of one evaluation, the median of several
};

/// @param file     of the weights
/// @param start    the state that it is evaluated at
/// @param threads  0: as many as OpenMP gives
/// @throws LoadError if the weights cannot be used
NetworkCost network_cost(const std::string& file, const ComparisonScene& scene,
                         const ClothState& start, int threads);

}  // namespace cloth
