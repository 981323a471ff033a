#pragma once

#include <torch/torch.h>

#include <map>
#include <memory>
#include <vector>

#include "gnn/graph/features.h"
#include "gnn/model/weights.h"
#include "gnn/train/graph_tables.h"
#include "gnn/train/message_op.h"
#include "gnn/train/parameters.h"

namespace cloth {

/// Normalisation of the four feature matrices.
struct NetworkStatistics {
    FeatureStatistics node, edge, world, body;
};

/// MeshGraphNets (Pfaff et al. 2021) with FastClothGNN's sampling and message reduction, in
/// LibTorch: encoders, `steps` message passing blocks with weights of their own, decoder. With
/// coarse levels a step updates the nodes of its finest level alone.
///
/// First layers are split, W [e, v_i, v_j] = C e + A v_i + B v_j, with A v and B v computed once
/// per node: the same function for fewer operations.
class Network {
 public:
    Network(const ModelConfig& config, torch::Device device, std::uint64_t seed);
    ~Network();
    Network(const Network&) = delete;
    Network& operator=(const Network&) = delete;

    const ModelConfig& config() const { return m_config; }
    Parameters& parameters() { return m_parameters; }

    /// From now on LibTorch's own operations alone, not the fused one: what a user of LibTorch
    /// would have. The same function, slower.
    void use_plain_operations() { m_message_op = message_op_plain; }

    void set_statistics(const NetworkStatistics& statistics);
    const NetworkStatistics& statistics() const { return m_statistics; }

    /// Scaled accelerations (|V| x 3, float32, on the network's device), with gradient.
    /// @throws ArgumentError if the graph was not built with config().graph_settings()
    torch::Tensor forward(const ClothGraph& graph, const Features& features);

    Weights export_weights() const;
    /// @throws ArgumentError if the weights are of another configuration
    void import_weights(const Weights& weights);

 private:
    struct Step;
    struct World;
    struct WorldTables;

    void bind_parameters();
    MlpWeights bind_mlp(const std::string& name, const std::vector<std::string>& inputs) const;
    const GraphTables& tables_of(const ClothGraph& graph);
    torch::Tensor to_device(const Eigen::Ref<const MatrixF>& features,
                            const FeatureStatistics& statistics) const;
    torch::Tensor encode(const MlpWeights& weights, const torch::Tensor& features) const;
    std::vector<torch::Tensor> encode_edges(const GraphTables& tables,
                                            const Features& features) const;
    World encode_world(const Features& features) const;
    WorldTables world_tables(const GraphTables& tables, const World& world, int level) const;
    FusedOutput send_edges(const GraphTables& tables, int k, size_t slot,
                           const torch::Tensor& nodes, const torch::Tensor& edges) const;
    torch::Tensor world_messages(const Step& step, const torch::Tensor& nodes, World& world,
                                 const WorldTables& tables, bool last) const;

    decltype(&message_op) m_message_op = message_op;
    ModelConfig m_config;
    torch::Device m_device;
    Parameters m_parameters;
    NetworkStatistics m_statistics;
    MlpWeights m_node_encoder, m_world_encoder, m_body_encoder, m_decoder;
    std::map<int, MlpWeights> m_edge_encoders;  ///< per level in use
    std::vector<Step> m_steps;
    std::map<std::uint64_t, std::unique_ptr<GraphTables>> m_tables;
};

}  // namespace cloth
