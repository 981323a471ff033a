#pragma once

#include "gnn/graph/cloth_graph.h"
#include "gnn/graph/features.h"
#include "gnn/model/model_config.h"

namespace cloth {

/// Whether the graph has the levels, and the sampled edges in each step, that the network asks for:
/// it was built with config.graph_settings(). Looks at sizes alone.
bool is_graph_of(const ClothGraph& graph, const ModelConfig& config);

/// Whether the features are those of the graph, with the columns that the network has. Looks at
/// sizes alone, allocates nothing: for each frame.
bool are_features_of(const Features& features, const ClothGraph& graph, const ModelConfig& config);

}  // namespace cloth
