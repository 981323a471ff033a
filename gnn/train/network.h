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

    /// Threads that copy the features of a batch (1).
    void set_threads(int threads) { m_threads = threads; }

    void set_statistics(const NetworkStatistics& statistics);
    const NetworkStatistics& statistics() const { return m_statistics; }

    /// Scaled accelerations (|V| x 3, float32, on the network's device), with gradient.
    /// @throws ArgumentError if the graph was not built with config().graph_settings(), or the
    ///         features not for it with config().features
    torch::Tensor forward(const ClothGraph& graph, const Features& features);
    /// Several garments at once, as a GPU needs it to be busy: the rows of one behind those of the
    /// other, each as it would be alone. A GraphBatch gives the same; its tables would be made anew
    /// for each batch, where these are joined from those of the garments.
    /// @param graphs, features  one or more, of equal number
    torch::Tensor forward(const std::vector<const ClothGraph*>& graphs,
                          const std::vector<const Features*>& features);

    Weights export_weights() const;
    /// @throws ArgumentError if the weights are of another configuration, or not those of theirs
    void import_weights(const Weights& weights);

 private:
    struct Step;
    struct World;
    struct KeptTables {
        std::shared_ptr<const GraphTables> tables;
        std::int64_t last_use = 0;
    };
    struct WorldTables;

    void bind_parameters();
    MlpWeights bind_mlp(const std::string& name, const std::vector<std::string>& inputs) const;
    std::shared_ptr<const GraphTables> tables_of(const ClothGraph& graph);
    using Blocks = std::vector<Eigen::Ref<const MatrixF>>;  ///< of rows
    torch::Tensor to_device(const Blocks& features, const FeatureStatistics& statistics) const;
    torch::Tensor encode(const MlpWeights& weights, const torch::Tensor& features) const;
    std::vector<torch::Tensor> encode_edges(
        const std::vector<std::shared_ptr<const GraphTables>>& parts,
        const std::vector<const Features*>& features) const;
    World encode_world(const std::vector<const Features*>& features) const;
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
    std::map<std::uint64_t, KeptTables> m_tables;  ///< by ClothGraph::id
    std::int64_t m_uses = 0;
    int m_threads = 1;
};

}  // namespace cloth
