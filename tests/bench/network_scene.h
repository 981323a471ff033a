#pragma once

#include <memory>

#include "gnn/graph/features.h"
#include "gnn/model/model_config.h"

namespace cloth::test {

/// The T-shirt (3,991 vertices) as it hangs on the default body, half a second into motion 01_01.
/// Without assimp-testmodels: on a sphere that fills it.
struct TshirtMoment {
    TshirtMoment();
    Garment garment;
    Boundary boundary;
    ClothState state;
};

/// The moment as a network of this configuration sees it.
struct NetworkInput {
    NetworkInput(const TshirtMoment& moment, const ModelConfig& config);
    ClothGraph graph;
    Features features;
    int active = 0;  ///< vertices with a world edge
};

/// Multiply-adds of the matrix products of one evaluation as the engine arranges it (split first
/// layer, no message that nobody reads), times two; everything else is not counted.
struct NetworkFlops {
    double encoder = 0.0, edges = 0.0, products = 0.0, world = 0.0, nodes = 0.0, decoder = 0.0;
    double total() const { return encoder + edges + products + world + nodes + decoder; }
};
NetworkFlops network_flops(const ModelConfig& config, const NetworkInput& input);

}  // namespace cloth::test
