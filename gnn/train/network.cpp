#include "gnn/train/network.h"

#include <utility>

#include "data/core/errors.h"

namespace cloth {

using torch::Tensor;

/// Message tables of one garment.
struct Network::GraphTables {
    std::vector<std::unique_ptr<MessageTable>> edge;  ///< one, or one per step if sampled
    std::unique_ptr<MessageTable> node;
};

struct Network::Step {
    MlpWeights edge, world, node;
};

/// Latents of the world edges and of the virtual body nodes; row r is garment vertex vertices[r].
struct Network::World {
    int count = 0;
    Tensor edges, reverse_edges, bodies;
    std::unique_ptr<MessageTable> to_garment, to_body, body;
};

Network::Network(const ModelConfig& config, torch::Device device, std::uint64_t seed)
    : m_config(config), m_device(device), m_parameters(config, device, seed) {
    config.check();
    const auto unit = [](const FeatureLayout& layout) {
        return StatisticsAccumulator(layout).statistics();
    };
    m_statistics = {unit(node_layout(config.features.force_features)), unit(edge_layout()),
                    unit(world_layout()), unit(body_layout())};
    bind_parameters();
}

Network::~Network() = default;

MlpWeights Network::bind_mlp(const std::string& name,
                             const std::vector<std::string>& inputs) const {
    MlpWeights weights;
    const auto view = [&](const std::string& part) { return m_parameters.view(name + part); };
    for (const std::string& input : inputs)
        weights.first.push_back(view(".first." + input + ".weight"));
    weights.first_bias = view(".first.bias");
    for (int layer = 1; layer < m_config.hidden_layers; ++layer) {
        weights.hidden.push_back(view(".hidden." + std::to_string(layer) + ".weight"));
        weights.hidden_bias.push_back(view(".hidden." + std::to_string(layer) + ".bias"));
    }
    weights.output = view(".output.weight");
    weights.output_bias = view(".output.bias");
    if (name == "decoder") return weights;
    weights.norm = view(".norm.weight");
    weights.norm_bias = view(".norm.bias");
    return weights;
}

void Network::bind_parameters() {
    m_node_encoder = bind_mlp("encoder.node", {"features"});
    m_edge_encoder = bind_mlp("encoder.edge", {"features"});
    m_world_encoder = bind_mlp("encoder.world", {"features"});
    m_body_encoder = bind_mlp("encoder.body", {"features"});
    m_decoder = bind_mlp("decoder", {"node"});
    for (int k = 0; k < m_config.steps; ++k) {
        const std::string name = "step." + std::to_string(k);
        Step step;
        step.edge = bind_mlp(name + ".edge", {"receiver", "sender", "edge"});
        std::vector<std::string> inputs = {"node", "mesh"};
        if (m_config.has_world(k)) {
            step.world = bind_mlp(name + ".world", {"receiver", "sender", "edge"});
            inputs.push_back("world");
        }
        step.node = bind_mlp(name + ".node", inputs);
        m_steps.push_back(std::move(step));
    }
}

static FusedRows edge_rows(const ClothGraph& graph, const std::vector<int>& edges, double scale) {
    FusedRows rows;
    rows.sums = graph.vertex_count;
    rows.sum_scale = static_cast<float>(scale);
    for (int e : edges) {
        if (e < 0) continue;
        rows.x_index.push_back(e);
        rows.product_index[0].push_back(graph.receivers[static_cast<size_t>(e)]);
        rows.product_index[1].push_back(graph.senders[static_cast<size_t>(e)]);
    }
    rows.sum_index = rows.product_index[0];
    rows.rows = static_cast<int>(rows.x_index.size());
    return rows;
}

static FusedRows plain_rows(int count, int sums) {
    FusedRows rows;
    rows.rows = count;
    rows.sums = sums;
    return rows;
}

const Network::GraphTables& Network::tables_of(const ClothGraph& graph) {
    std::unique_ptr<GraphTables>& tables = m_tables[graph.id];
    if (tables) return *tables;
    if (m_tables.size() > 256) {  // short-lived garments must not pile up
        m_tables.clear();
        return tables_of(graph);
    }
    tables = std::make_unique<GraphTables>();
    const double scale = m_config.message_scale;
    if (m_config.sampled_edges == 0) {
        FusedRows rows = plain_rows(graph.edge_count(), graph.vertex_count);
        rows.product_index[0] = graph.receivers;
        rows.product_index[1] = graph.senders;
        rows.sum_index = graph.receivers;
        rows.sum_scale = static_cast<float>(scale);
        tables->edge.push_back(std::make_unique<MessageTable>(std::move(rows), m_device));
    } else {
        for (const auto& step : graph.schedule.edges)
            tables->edge.push_back(
                std::make_unique<MessageTable>(edge_rows(graph, step, scale), m_device));
    }
    tables->node = std::make_unique<MessageTable>(plain_rows(graph.vertex_count, 0), m_device);
    return *tables;
}

Tensor Network::to_device(const MatrixF& features, const FeatureStatistics& statistics) const {
    // Zero columns fill up to a multiple of 16, which the fused operation asks for.
    const Eigen::Index padded = (features.cols() + 15) / 16 * 16;
    Tensor rows = torch::zeros({features.rows(), padded}, torch::kFloat32);
    Eigen::Map<MatrixF> map(rows.data_ptr<float>(), features.rows(), padded);
    map.leftCols(features.cols()) =
        (features.rowwise() - statistics.mean.transpose()).array().rowwise() /
        statistics.deviation.transpose().array();
    return rows.to(m_device);
}

Tensor Network::encode(const MlpWeights& weights, const Tensor& features) const {
    MlpWeights padded = weights;
    const auto missing = features.size(1) - weights.first[0].size(1);
    padded.first[0] = torch::constant_pad_nd(weights.first[0], {0, missing});
    const int rows = static_cast<int>(features.size(0));
    const MessageTable table(plain_rows(rows, rows), m_device);
    return m_message_op({features}, {0}, {}, padded, table, false).sum;
}

/// The world edge seen from the body: both relative vectors change sign.
static Tensor reversed(const Tensor& world) {
    std::vector<float> signs(static_cast<size_t>(world.size(1)), 1.0f);
    size_t column = 0;
    for (const FeatureGroup& group : world_layout()) {
        const bool flips = group.name.rfind("relative", 0) == 0;
        for (int k = 0; k < group.size; ++k) signs[column++] = flips ? -1.0f : 1.0f;
    }
    return world * torch::tensor(signs).to(world.device());
}

Network::World Network::encode_world(const Features& features) const {
    World world;
    std::vector<int> vertices;
    for (Eigen::Index i = 0; i < features.world_mask.size(); ++i)
        if (features.world_mask[i] != 0.0f) vertices.push_back(static_cast<int>(i));
    world.count = static_cast<int>(vertices.size());
    if (world.count == 0) return world;
    MatrixF edges(world.count, features.world.cols()), bodies(world.count, features.body.cols());
    for (int r = 0; r < world.count; ++r) {
        edges.row(r) = features.world.row(vertices[static_cast<size_t>(r)]);
        bodies.row(r) = features.body.row(vertices[static_cast<size_t>(r)]);
    }
    const Tensor edge_features = to_device(edges, m_statistics.world);
    world.edges = encode(m_world_encoder, edge_features);
    world.bodies = encode(m_body_encoder, to_device(bodies, m_statistics.body));
    FusedRows rows = plain_rows(world.count, static_cast<int>(features.world_mask.size()));
    rows.product_index[0] = vertices;
    rows.sum_index = vertices;
    world.to_garment = std::make_unique<MessageTable>(rows, m_device);
    if (!m_config.body_updates) return world;
    world.reverse_edges = encode(m_world_encoder, reversed(edge_features));
    FusedRows back = plain_rows(world.count, world.count);
    back.product_index[1] = vertices;
    world.to_body = std::make_unique<MessageTable>(std::move(back), m_device);
    world.body = std::make_unique<MessageTable>(plain_rows(world.count, 0), m_device);
    return world;
}

static Tensor product(const Tensor& latents, const Tensor& weight) {
    return torch::mm(latents, weight.t());
}

Tensor Network::world_messages(const Step& step, const Tensor& nodes, World& world,
                               bool last) const {
    const Tensor& receiver = step.world.first[0];
    const Tensor& sender = step.world.first[1];
    const bool keep = m_config.world_every_step && !last;
    FusedOutput to_garment =
        m_message_op({world.edges}, {2}, {product(nodes, receiver), product(world.bodies, sender)},
                     step.world, *world.to_garment, keep);
    if (m_config.body_updates && !last) {
        FusedOutput to_body = m_message_op(
            {world.reverse_edges}, {2}, {product(world.bodies, receiver), product(nodes, sender)},
            step.world, *world.to_body, keep);
        // Body nodes share the garment's node network; they have no mesh edges.
        world.bodies =
            m_message_op({world.bodies, to_body.sum}, {0, 2}, {}, step.node, *world.body, true).out;
        world.reverse_edges = to_body.out;
    }
    if (keep) world.edges = to_garment.out;
    return to_garment.sum;
}

Tensor Network::forward(const ClothGraph& graph, const Features& features) {
    const GraphTables& tables = tables_of(graph);
    Tensor nodes = encode(m_node_encoder, to_device(features.node, m_statistics.node));
    Tensor edges = encode(m_edge_encoder, to_device(features.edge, m_statistics.edge));
    World world = encode_world(features);
    for (int k = 0; k < m_config.steps; ++k) {
        const Step& step = m_steps[static_cast<size_t>(k)];
        const bool last = k + 1 == m_config.steps;
        const MessageTable& table =
            *tables.edge[tables.edge.size() == 1 ? 0 : static_cast<size_t>(k)];
        FusedOutput mesh = m_message_op(
            {edges}, {2}, {product(nodes, step.edge.first[0]), product(nodes, step.edge.first[1])},
            step.edge, table, !last);
        std::vector<Tensor> inputs = {nodes, mesh.sum};
        if (m_config.has_world(k) && world.count > 0)
            inputs.push_back(world_messages(step, nodes, world, last));
        nodes = m_message_op(inputs, {0, 1, 2}, {}, step.node, *tables.node, true).out;
        if (!last) edges = mesh.out;
    }
    return mlp(m_decoder, nodes);
}

void Network::set_statistics(const NetworkStatistics& statistics) {
    m_statistics = statistics;
}

static WeightTensor to_tensor(const VectorF& values) {
    return {{static_cast<int>(values.size())}, {values.data(), values.data() + values.size()}};
}

static VectorF to_vector(const WeightTensor& tensor) {
    return Eigen::Map<const VectorF>(tensor.data.data(),
                                     static_cast<Eigen::Index>(tensor.data.size()));
}

Weights Network::export_weights() const {
    Weights weights;
    weights.config = m_config;
    m_parameters.copy_to(weights);
    const std::pair<const char*, const FeatureStatistics*> parts[] = {
        {"node", &m_statistics.node},
        {"edge", &m_statistics.edge},
        {"world", &m_statistics.world},
        {"body", &m_statistics.body}};
    for (const auto& [name, statistics] : parts) {
        const std::string prefix = std::string("statistics.") + name;
        weights.tensors[prefix + ".mean"] = to_tensor(statistics->mean);
        weights.tensors[prefix + ".deviation"] = to_tensor(statistics->deviation);
    }
    return weights;
}

void Network::import_weights(const Weights& weights) {
    if (!(weights.config == m_config))
        throw ArgumentError("weights", "are of another network configuration",
                            "make the network from weights.config");
    m_parameters.copy_from(weights);
    const auto read = [&](const std::string& name) {
        return FeatureStatistics{to_vector(weights.tensor("statistics." + name + ".mean")),
                                 to_vector(weights.tensor("statistics." + name + ".deviation"))};
    };
    m_statistics = {read("node"), read("edge"), read("world"), read("body")};
}

}  // namespace cloth
