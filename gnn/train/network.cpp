#include "gnn/train/network.h"

#include <utility>

#include "data/core/errors.h"
#include "gnn/model/graph_fit.h"
#include "gnn/model/weights_check.h"
#include "gnn/train/setting_differences.h"

namespace cloth {

using torch::Tensor;

struct Network::Step {
    std::vector<MlpWeights> edge;  ///< per level of the step
    MlpWeights world, node;
};

/// Latents of the world edges and of the virtual body nodes; row r is garment vertex vertices[r].
struct Network::World {
    std::vector<int> vertices;
    Tensor edges, reverse_edges, bodies;
};

/// Message tables of the world edges of one level's vertices.
struct Network::WorldTables {
    int count = 0;
    Tensor nodes;  ///< GraphTables::Level::vertices
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
    for (const int level : m_config.used_levels())
        m_edge_encoders[level] = bind_mlp("encoder." + level_name("edge", level), {"features"});
    m_world_encoder = bind_mlp("encoder.world", {"features"});
    m_body_encoder = bind_mlp("encoder.body", {"features"});
    m_decoder = bind_mlp("decoder", {"node"});
    for (int k = 0; k < m_config.steps; ++k) {
        const std::string name = "step." + std::to_string(k);
        Step step;
        std::vector<std::string> inputs = {"node"};
        for (const int level : m_config.levels(k)) {
            step.edge.push_back(
                bind_mlp(name + "." + level_name("edge", level), {"receiver", "sender", "edge"}));
            inputs.push_back(level_name("mesh", level));
        }
        if (m_config.has_world(k)) {
            step.world = bind_mlp(name + ".world", {"receiver", "sender", "edge"});
            inputs.push_back("world");
        }
        step.node = bind_mlp(name + ".node", inputs);
        m_steps.push_back(std::move(step));
    }
}

static FusedRows plain_rows(int count, int sums) {
    FusedRows rows;
    rows.rows = count;
    rows.sums = sums;
    return rows;
}

std::shared_ptr<const GraphTables> Network::tables_of(const ClothGraph& graph) {
    constexpr std::int64_t kept_uses = 2048;
    if (m_tables.size() > 256)  // short-lived garments must not pile up
        for (auto kept = m_tables.begin(); kept != m_tables.end();)
            kept = m_uses - kept->second.last_use > kept_uses ? m_tables.erase(kept) : ++kept;
    const auto known = m_tables.find(graph.id);
    if (known == m_tables.end() && !is_graph_of(graph, m_config))
        throw ArgumentError("graph", "has other levels or sampled edges than the network",
                            "build it with config().graph_settings()");
    KeptTables& kept = m_tables[graph.id];
    if (!kept.tables) kept.tables = std::make_shared<const GraphTables>(graph, m_config, m_device);
    kept.last_use = ++m_uses;
    return kept.tables;
}

Tensor Network::to_device(const Blocks& features, const FeatureStatistics& statistics) const {
    std::vector<Eigen::Index> first = {0};  // row of each block
    for (const auto& block : features) first.push_back(first.back() + block.rows());
    const Eigen::Index columns = statistics.mean.size();
    // Zero columns fill up to a multiple of 16, which the fused operation asks for.
    const Eigen::Index padded = (columns + 15) / 16 * 16;
    Tensor rows = torch::empty({first.back(), padded}, torch::kFloat32);
    Eigen::Map<MatrixF> map(rows.data_ptr<float>(), first.back(), padded);
    const int count = static_cast<int>(features.size());
#pragma omp parallel for schedule(dynamic, 1) num_threads(m_threads) if (m_threads > 1 && count > 1)
    for (int k = 0; k < count; ++k) {
        const auto& block = features[static_cast<size_t>(k)];
        auto to = map.middleRows(first[static_cast<size_t>(k)], block.rows());
        to.leftCols(columns) = (block.rowwise() - statistics.mean.transpose()).array().rowwise() /
                               statistics.deviation.transpose().array();
        to.rightCols(padded - columns).setZero();
    }
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

std::vector<Tensor> Network::encode_edges(
    const std::vector<std::shared_ptr<const GraphTables>>& parts,
    const std::vector<const Features*>& features) const {
    std::vector<Tensor> latents(parts[0]->levels.size());
    for (const auto& [number, encoder] : m_edge_encoders) {
        Blocks blocks;
        Eigen::Index edges = 0;
        for (size_t k = 0; k < parts.size(); ++k) {
            const GraphTables::Level& level = parts[k]->level(number);
            blocks.emplace_back(features[k]->edge.middleRows(level.first_edge, level.edges));
            edges += level.edges;
        }
        if (edges > 0)
            latents[static_cast<size_t>(number)] =
                encode(encoder, to_device(blocks, m_statistics.edge));
    }
    return latents;
}

Network::World Network::encode_world(const std::vector<const Features*>& features) const {
    World world;
    std::vector<MatrixF> edges, bodies;
    int first_vertex = 0;
    for (const Features* own : features) {
        std::vector<int> touched;
        for (Eigen::Index i = 0; i < own->world_mask.size(); ++i)
            if (own->world_mask[i] != 0.0f) touched.push_back(static_cast<int>(i));
        edges.push_back(own->world(touched, Eigen::all));
        bodies.push_back(own->body(touched, Eigen::all));
        for (const int vertex : touched) world.vertices.push_back(first_vertex + vertex);
        first_vertex += static_cast<int>(own->world_mask.size());
    }
    if (world.vertices.empty()) return world;
    const Tensor edge_features = to_device({edges.begin(), edges.end()}, m_statistics.world);
    world.edges = encode(m_world_encoder, edge_features);
    world.bodies =
        encode(m_body_encoder, to_device({bodies.begin(), bodies.end()}, m_statistics.body));
    if (m_config.body_updates)
        world.reverse_edges = encode(m_world_encoder, reversed(edge_features));
    return world;
}

Network::WorldTables Network::world_tables(const GraphTables& tables, const World& world,
                                           int level) const {
    const GraphTables::Level& nodes = tables.level(level);
    std::vector<int> vertices, rows;  // rows: none on level 0, which has all of them
    for (size_t r = 0; r < world.vertices.size(); ++r) {
        const int vertex = world.vertices[r];
        if (level > 0 && nodes.node_of[static_cast<size_t>(vertex)] < 0) continue;
        vertices.push_back(vertex);
        if (level > 0) rows.push_back(static_cast<int>(r));
    }
    WorldTables result;
    result.count = static_cast<int>(vertices.size());
    result.nodes = nodes.vertices;
    if (result.count == 0) return result;
    const std::vector<int> receivers = nodes.rows_of(vertices);
    FusedRows to_garment = plain_rows(result.count, nodes.nodes);
    to_garment.x_index = rows;
    to_garment.product_index[0] = receivers;
    to_garment.sum_index = receivers;
    result.to_garment = std::make_unique<MessageTable>(std::move(to_garment), m_device);
    if (!m_config.body_updates) return result;
    FusedRows to_body = plain_rows(result.count, result.count);
    to_body.x_index = rows;
    to_body.product_index[1] = receivers;
    result.to_body = std::make_unique<MessageTable>(std::move(to_body), m_device);
    FusedRows body = plain_rows(result.count, 0);
    body.x_index = std::move(rows);
    result.body = std::make_unique<MessageTable>(std::move(body), m_device);
    return result;
}

static Tensor product(const Tensor& latents, const Tensor& weight) {
    return torch::mm(latents, weight.t());
}

Tensor Network::world_messages(const Step& step, const Tensor& nodes, World& world,
                               const WorldTables& tables, bool last) const {
    const Tensor& receiver = step.world.first[0];
    const Tensor& sender = step.world.first[1];
    const bool keep = m_config.world_every_step && !last;
    const Tensor of_level = rows_at(nodes, tables.nodes);
    const Tensor bodies = rows_at(world.bodies, tables.to_garment->x_index);
    FusedOutput to_garment =
        m_message_op({world.edges}, {2}, {product(of_level, receiver), product(bodies, sender)},
                     step.world, *tables.to_garment, keep);
    if (m_config.body_updates && !last) {
        FusedOutput to_body = m_message_op({world.reverse_edges}, {2},
                                           {product(bodies, receiver), product(of_level, sender)},
                                           step.world, *tables.to_body, keep);
        // Body nodes share the garment's node network; they have no mesh edges.
        const int input = static_cast<int>(step.edge.size()) + 1;
        world.bodies =
            m_message_op({world.bodies, to_body.sum}, {0, input}, {}, step.node, *tables.body, true)
                .out;
        world.reverse_edges = to_body.out;
    }
    if (keep) world.edges = to_garment.out;
    return to_garment.sum;
}

FusedOutput Network::send_edges(const GraphTables& tables, int k, size_t slot, const Tensor& nodes,
                                const Tensor& edges) const {
    const MessageTable& table = tables.edge_table(k, slot);
    if (table.rows->rows == 0)
        return {edges, torch::zeros({table.rows->sums, nodes.size(1)}, nodes.options())};
    const MlpWeights& weights = m_steps[static_cast<size_t>(k)].edge[slot];
    const int level = m_config.levels(k)[slot];
    const Tensor of_level = rows_at(nodes, tables.level(level).vertices);
    return m_message_op({edges}, {2},
                        {product(of_level, weights.first[0]), product(of_level, weights.first[1])},
                        weights, table, m_config.uses_after(level, k));
}

Tensor Network::forward(const ClothGraph& graph, const Features& features) {
    return forward(std::vector<const ClothGraph*>{&graph}, {&features});
}

Tensor Network::forward(const std::vector<const ClothGraph*>& graphs,
                        const std::vector<const Features*>& features) {
    std::vector<std::shared_ptr<const GraphTables>> parts;
    Blocks node_features;
    for (size_t k = 0; k < graphs.size(); ++k) {
        parts.push_back(tables_of(*graphs[k]));
        if (!are_features_of(*features[k], *graphs[k], m_config))
            throw ArgumentError("features", "are not those of the graph and of the network",
                                "build them by FeatureBuilder with config().features");
        node_features.emplace_back(features[k]->node);
    }
    const auto joined = parts.size() == 1
                            ? parts[0]
                            : std::make_shared<const GraphTables>(parts, m_config, m_device);
    const GraphTables& tables = *joined;
    Tensor nodes = encode(m_node_encoder, to_device(node_features, m_statistics.node));
    std::vector<Tensor> edges = encode_edges(parts, features);
    World world = encode_world(features);
    std::map<int, WorldTables> world_tables_of;
    for (int k = 0; k < m_config.steps; ++k) {
        const Step& step = m_steps[static_cast<size_t>(k)];
        const bool last = k + 1 == m_config.steps;
        const std::vector<int>& levels = m_config.levels(k);
        const GraphTables::Level& finest = tables.level(levels.front());
        if (finest.nodes == 0) continue;  // a garment too small for this level
        std::vector<Tensor> inputs = {nodes};
        std::vector<int> numbers = {0};
        for (size_t slot = 0; slot < levels.size(); ++slot) {
            Tensor& latents = edges[static_cast<size_t>(levels[slot])];
            FusedOutput mesh = send_edges(tables, k, slot, nodes, latents);
            inputs.push_back(mesh.sum);
            numbers.push_back(static_cast<int>(numbers.size()));
            if (mesh.out.defined()) latents = mesh.out;
        }
        if (m_config.has_world(k) && !world.vertices.empty()) {
            auto [found, is_new] = world_tables_of.try_emplace(levels.front());
            if (is_new) found->second = world_tables(tables, world, levels.front());
            if (found->second.count > 0) {
                inputs.push_back(world_messages(step, nodes, world, found->second, last));
                numbers.push_back(static_cast<int>(numbers.size()));
            }
        }
        nodes = m_message_op(inputs, numbers, {}, step.node, *finest.update, true).out;
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
    m_parameters.copy_to(weights.tensors);
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
        throw ArgumentError(
            "weights of '" + weights.solver_name() + "'",
            "are of another network: " + to_text(differences(weights.config, m_config), "this one"),
            "make the network from weights.config");
    const TensorProblem problem = find_problem(weights);
    if (!problem.place.empty())
        throw ArgumentError("weights of '" + weights.solver_name() + "', " + problem.place,
                            problem.text, "give the tensors of the configuration");
    m_parameters.copy_from(weights.tensors);
    const auto read = [&](const std::string& name) {
        return FeatureStatistics{to_vector(weights.tensor("statistics." + name + ".mean")),
                                 to_vector(weights.tensor("statistics." + name + ".deviation"))};
    };
    m_statistics = {read("node"), read("edge"), read("world"), read("body")};
}

}  // namespace cloth
