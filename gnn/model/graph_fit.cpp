#include "gnn/model/graph_fit.h"

namespace cloth {

namespace {

template <size_t count>
constexpr int columns_of(const FeatureGroup (&groups)[count]) {
    return detail::columns_of(groups, static_cast<int>(count));
}

constexpr int node_columns = columns_of(node_groups), edge_columns = columns_of(edge_groups),
              world_columns = columns_of(world_groups), body_columns = columns_of(body_groups);
constexpr int node_columns_without_forces = first_column<NodeFeature::elastic_now>;

bool has_size(const MatrixF& matrix, Eigen::Index rows, int columns) {
    return matrix.rows() == rows && matrix.cols() == columns;
}

}  // namespace

bool is_graph_of(const ClothGraph& graph, const ModelConfig& config) {
    if (static_cast<int>(graph.coarse.size()) != coarsest_level(config.level_schedule))
        return false;
    const auto fan_in = static_cast<size_t>(config.sampled_edges);
    for (int k = 0; k < config.steps; ++k)
        for (const int level : config.levels(k)) {
            const SamplingSchedule& sampling = graph.level_sampling(level);
            if (sampling.fan_in != config.sampled_edges) return false;
            if (fan_in == 0) continue;
            const size_t nodes = level == 0
                                     ? static_cast<size_t>(graph.vertex_count)
                                     : graph.coarse[static_cast<size_t>(level) - 1].nodes.size();
            if (sampling.edges.size() != static_cast<size_t>(config.steps) ||
                sampling.edges[static_cast<size_t>(k)].size() != nodes * fan_in)
                return false;
        }
    return true;
}

bool are_features_of(const Features& features, const ClothGraph& graph, const ModelConfig& config) {
    const Eigen::Index vertices = graph.vertex_count;
    const int of_node = config.features.force_features ? node_columns : node_columns_without_forces;
    if (!has_size(features.node, vertices, of_node) ||
        !has_size(features.edge, graph.edge_count(), edge_columns))
        return false;
    if (features.world_mask.size() == 0) return true;  // nothing is near
    return features.world_mask.size() == vertices &&
           has_size(features.world, vertices, world_columns) &&
           has_size(features.body, vertices, body_columns);
}

}  // namespace cloth
