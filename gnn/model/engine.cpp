#include "gnn/model/engine.h"

#include <omp.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "data/errors.h"
#include "gnn/model/message_block.h"

// The vertices are cut into groups. Within a message step everything that a group writes belongs to
// its own vertices: its incoming edges, its world edges, its node latents. The only thing it reads
// of others are the senders' products B v, which are computed a step ahead into the other of two
// buffers. So groups run in any order on any thread with one barrier per step, and each sum is
// always taken in the same order.

namespace cloth {
namespace {

constexpr int group_size = 192;  // vertices: edge latents of a group stay in the second-level cache

int padded(int columns) {
    return (columns + 15) / 16 * 16;
}

/// Weights of one perceptron as the message block wants them.
struct Mlp {
    MessageBlockWeights block;
    std::vector<std::vector<float>> own;  // encoder inputs are filled up to a multiple of 16
};

/// Edge rows of one message step, sorted by receiver.
struct EdgeTable {
    std::vector<int> edges, receivers, senders;
    std::vector<int> first_row;  // per group, and one past the last
};

using Buffer = std::vector<float>;

}  // namespace

struct Engine::Implementation {
    struct Step {
        Mlp edge, world, node, body;
        const float *receiver = nullptr, *sender = nullptr;  // A and B of the edge update
    };

    std::shared_ptr<const Weights> weights;
    EngineSettings settings;
    Mlp node_encoder, edge_encoder, world_encoder, body_encoder;
    std::vector<Step> steps;
    const float *decoder_w1, *decoder_b1, *decoder_w2, *decoder_b2, *decoder_w3, *decoder_b3;

    std::uint64_t graph_id = 0;
    int vertices = 0, groups = 0;
    std::vector<EdgeTable> tables;
    std::vector<int> first_edge;

    Buffer node_in, edge_in, world_in, reverse_in, body_in;
    Buffer nodes, edges, mesh_sum, world_sum;
    Buffer world, reverse, bodies, body_sum;
    Buffer product_receiver, product_sender[2];
    std::vector<int> active;        // garment vertices with a world edge, ascending
    std::vector<int> first_active;  // per group, and one past the last
    std::vector<MessageBlockScratch> scratch;
    std::vector<Buffer> decoded;

    int width() const { return weights->config.width; }
    const float* data(const std::string& name) const { return weights->tensor(name).data.data(); }

    Mlp mlp(const std::string& name, const std::vector<std::string>& inputs) const;
    void bind();
    void prepare(const ClothGraph& graph);
    void resize_buffers(const ClothGraph& graph);
    void read_features(const Features& features);
    void read_world(const Features& features);
    void encode_group(int group, MessageBlockScratch& buffer);
    void run_step(int group, size_t step, MessageBlockScratch& buffer);
    void send_edges(int group, size_t step, MessageBlockScratch& buffer);
    void send_world(int group, size_t step, MessageBlockScratch& buffer);
    void update_nodes(int group, size_t step, MessageBlockScratch& buffer);
    void make_products(int group, size_t step, MessageBlockScratch& buffer);
    void decode_group(int group, int thread, Points& out);

    int first_vertex(int group) const { return std::min(vertices, group * group_size); }
    float* row(Buffer& buffer, int index) const {
        return buffer.data() + static_cast<size_t>(index) * static_cast<size_t>(width());
    }
};

Mlp Engine::Implementation::mlp(const std::string& name,
                                const std::vector<std::string>& inputs) const {
    Mlp result;
    MessageBlockWeights& block = result.block;
    block.width = width();
    for (const std::string& input : inputs) {
        const WeightTensor& tensor = weights->tensor(name + ".first." + input + ".weight");
        const int columns = tensor.shape[1], wide = padded(columns);
        const float* values = tensor.data.data();
        if (wide != columns) {
            Buffer copy(static_cast<size_t>(width() * wide), 0.0f);
            for (int o = 0; o < width(); ++o)
                std::copy_n(values + o * columns, columns, copy.begin() + o * wide);
            result.own.push_back(std::move(copy));
            values = result.own.back().data();
        }
        block.in[block.inputs] = wide;
        block.w1[block.inputs++] = values;
    }
    block.b1 = data(name + ".first.bias");
    block.w2 = data(name + ".hidden.1.weight");
    block.b2 = data(name + ".hidden.1.bias");
    block.w3 = data(name + ".output.weight");
    block.b3 = data(name + ".output.bias");
    block.gamma = data(name + ".norm.weight");
    block.beta = data(name + ".norm.bias");
    return result;
}

void Engine::Implementation::bind() {
    node_encoder = mlp("encoder.node", {"features"});
    edge_encoder = mlp("encoder.edge", {"features"});
    world_encoder = mlp("encoder.world", {"features"});
    body_encoder = mlp("encoder.body", {"features"});
    for (int k = 0; k < weights->config.steps; ++k) {
        const std::string name = "step." + std::to_string(k);
        Step step;
        step.edge = mlp(name + ".edge", {"edge"});
        step.receiver = data(name + ".edge.first.receiver.weight");
        step.sender = data(name + ".edge.first.sender.weight");
        std::vector<std::string> inputs = {"node", "mesh"};
        if (weights->config.has_world(k)) {
            step.world = mlp(name + ".world", {"edge", "receiver", "sender"});
            step.body = mlp(name + ".node", {"node", "world"});
            inputs.push_back("world");
        }
        step.node = mlp(name + ".node", inputs);
        steps.push_back(std::move(step));
    }
    decoder_w1 = data("decoder.first.node.weight");
    decoder_b1 = data("decoder.first.bias");
    decoder_w2 = data("decoder.hidden.1.weight");
    decoder_b2 = data("decoder.hidden.1.bias");
    decoder_w3 = data("decoder.output.weight");
    decoder_b3 = data("decoder.output.bias");
}

static EdgeTable edge_table(const ClothGraph& graph, const std::vector<int>* sampled, int groups) {
    EdgeTable table;
    const int count = sampled ? static_cast<int>(sampled->size()) : graph.edge_count();
    for (int k = 0; k < count; ++k) {
        const int edge = sampled ? (*sampled)[static_cast<size_t>(k)] : k;
        if (edge < 0) continue;
        table.edges.push_back(edge);
        table.receivers.push_back(graph.receivers[static_cast<size_t>(edge)]);
        table.senders.push_back(graph.senders[static_cast<size_t>(edge)]);
    }
    for (int group = 0; group <= groups; ++group)
        table.first_row.push_back(static_cast<int>(
            std::lower_bound(table.receivers.begin(), table.receivers.end(), group * group_size) -
            table.receivers.begin()));
    return table;
}

void Engine::Implementation::prepare(const ClothGraph& graph) {
    if (graph.id == graph_id && vertices == graph.vertex_count) return;
    graph_id = graph.id;
    vertices = graph.vertex_count;
    groups = (vertices + group_size - 1) / group_size;
    first_edge = graph.first_edge;
    tables.clear();
    if (weights->config.sampled_edges == 0)
        tables.push_back(edge_table(graph, nullptr, groups));
    else
        for (const std::vector<int>& step : graph.schedule.edges)
            tables.push_back(edge_table(graph, &step, groups));
    resize_buffers(graph);
}

void Engine::Implementation::resize_buffers(const ClothGraph& graph) {
    const size_t v = static_cast<size_t>(vertices), d = static_cast<size_t>(width());
    const size_t e = static_cast<size_t>(graph.edge_count());
    node_in.assign(v * static_cast<size_t>(node_encoder.block.in[0]), 0.0f);
    edge_in.assign(e * static_cast<size_t>(edge_encoder.block.in[0]), 0.0f);
    world_in.assign(v * static_cast<size_t>(world_encoder.block.in[0]), 0.0f);
    body_in.assign(v * static_cast<size_t>(body_encoder.block.in[0]), 0.0f);
    for (Buffer* buffer : {&nodes, &mesh_sum, &world_sum, &world, &bodies, &product_receiver,
                           &product_sender[0], &product_sender[1]})
        buffer->assign(v * d, 0.0f);
    edges.assign(e * d, 0.0f);
    if (weights->config.body_updates) {
        reverse_in.assign(world_in.size(), 0.0f);
        reverse.assign(v * d, 0.0f);
        body_sum.assign(v * d, 0.0f);
    }
    active.reserve(v);
    first_active.resize(static_cast<size_t>(groups) + 1);
    const size_t threads =
        static_cast<size_t>(settings.threads > 0 ? settings.threads : omp_get_max_threads());
    scratch.resize(threads);
    decoded.assign(threads, Buffer(2 * group_size * d));
}

static void normalise_row(const MatrixF& features, Eigen::Index from, const float* mean,
                          const float* deviation, float* to) {
    for (Eigen::Index c = 0; c < features.cols(); ++c)
        to[c] = (features(from, c) - mean[c]) / deviation[c];
}

void Engine::Implementation::read_features(const Features& features) {
    const auto read = [this](const MatrixF& matrix, const std::string& name, int stride,
                             Buffer& to) {
        const float* mean = data("statistics." + name + ".mean");
        const float* deviation = data("statistics." + name + ".deviation");
        for (Eigen::Index r = 0; r < matrix.rows(); ++r)
            normalise_row(matrix, r, mean, deviation, to.data() + r * stride);
    };
    read(features.node, "node", node_encoder.block.in[0], node_in);
    read(features.edge, "edge", edge_encoder.block.in[0], edge_in);
    read_world(features);
}

/// The world edge seen from the body: its relative vectors change sign.
static void reverse_row(const float* from, int columns, float* to) {
    std::copy_n(from, columns, to);
    int column = 0;
    for (const FeatureGroup& group : world_layout()) {
        if (group.name.rfind("relative", 0) == 0)
            for (int k = 0; k < group.size; ++k) to[column + k] = -to[column + k];
        column += group.size;
    }
}

void Engine::Implementation::read_world(const Features& features) {
    active.clear();
    const float* mean[] = {data("statistics.world.mean"), data("statistics.body.mean")};
    const float* deviation[] = {data("statistics.world.deviation"),
                                data("statistics.body.deviation")};
    const int world_columns = world_encoder.block.in[0], body_columns = body_encoder.block.in[0];
    for (int i = 0; i < vertices; ++i) {
        if (i % group_size == 0)
            first_active[static_cast<size_t>(i / group_size)] = static_cast<int>(active.size());
        if (features.world_mask.size() <= i || features.world_mask[i] == 0.0f) continue;
        const int r = static_cast<int>(active.size());
        active.push_back(i);
        normalise_row(features.world, i, mean[0], deviation[0],
                      world_in.data() + r * world_columns);
        normalise_row(features.body, i, mean[1], deviation[1], body_in.data() + r * body_columns);
        if (weights->config.body_updates)
            reverse_row(world_in.data() + r * world_columns, world_columns,
                        reverse_in.data() + r * world_columns);
    }
    first_active.back() = static_cast<int>(active.size());
}

/// Rows [first, last) of a matrix through an encoder.
static void encode_rows(const Mlp& encoder, const Buffer& in, int first, int last, Buffer& out,
                        MessageBlockScratch& scratch) {
    MessageBlockRows rows;
    rows.rows = last - first;
    rows.x[0] = in.data() + static_cast<size_t>(first) * static_cast<size_t>(encoder.block.in[0]);
    const size_t d = static_cast<size_t>(encoder.block.width);
    float* to = out.data() + static_cast<size_t>(first) * d;
    std::fill_n(to, static_cast<size_t>(rows.rows) * d, 0.0f);
    message_block_forward(encoder.block, rows, nullptr, to, scratch);
}

void Engine::Implementation::encode_group(int group, MessageBlockScratch& buffer) {
    const int v0 = first_vertex(group), v1 = first_vertex(group + 1);
    encode_rows(node_encoder, node_in, v0, v1, nodes, buffer);
    encode_rows(edge_encoder, edge_in, first_edge[static_cast<size_t>(v0)],
                first_edge[static_cast<size_t>(v1)], edges, buffer);
    const int w0 = first_active[static_cast<size_t>(group)];
    const int w1 = first_active[static_cast<size_t>(group) + 1];
    encode_rows(world_encoder, world_in, w0, w1, world, buffer);
    encode_rows(body_encoder, body_in, w0, w1, bodies, buffer);
    if (weights->config.body_updates)
        encode_rows(world_encoder, reverse_in, w0, w1, reverse, buffer);
    make_products(group, 0, buffer);
}

void Engine::Implementation::make_products(int group, size_t step, MessageBlockScratch& buffer) {
    const int v0 = first_vertex(group), count = first_vertex(group + 1) - v0, d = width();
    dense_layer(count, d, d, row(nodes, v0), steps[step].receiver, nullptr, false,
                row(product_receiver, v0), buffer);
    dense_layer(count, d, d, row(nodes, v0), steps[step].sender, nullptr, false,
                row(product_sender[step % 2], v0), buffer);
}

void Engine::Implementation::send_edges(int group, size_t step, MessageBlockScratch& buffer) {
    const EdgeTable& table = tables[tables.size() == 1 ? 0 : step];
    const int first = table.first_row[static_cast<size_t>(group)];
    const int v0 = first_vertex(group), v1 = first_vertex(group + 1);
    std::fill(row(mesh_sum, v0), row(mesh_sum, v1), 0.0f);
    MessageBlockRows rows;
    rows.rows = table.first_row[static_cast<size_t>(group) + 1] - first;
    rows.x[0] = edges.data();
    rows.x_index[0] = table.edges.data() + first;
    rows.products = 2;
    rows.p[0] = product_receiver.data();
    rows.p_index[0] = table.receivers.data() + first;
    rows.p[1] = product_sender[step % 2].data();
    rows.p_index[1] = table.senders.data() + first;
    rows.sum_index = table.receivers.data() + first;
    rows.sum_scale = static_cast<float>(weights->config.message_scale);
    const bool last = step + 1 == steps.size();
    message_block_forward(steps[step].edge.block, rows, last ? nullptr : edges.data(),
                          mesh_sum.data(), buffer);
}

void Engine::Implementation::send_world(int group, size_t step, MessageBlockScratch& buffer) {
    const int first = first_active[static_cast<size_t>(group)];
    const int count = first_active[static_cast<size_t>(group) + 1] - first;
    std::fill(row(world_sum, first_vertex(group)), row(world_sum, first_vertex(group + 1)), 0.0f);
    const bool last = step + 1 == steps.size();
    const bool keep = weights->config.world_every_step && !last;
    MessageBlockRows rows;
    rows.rows = count;
    rows.x[0] = row(world, first);
    rows.x[1] = nodes.data();
    rows.x_index[1] = active.data() + first;
    rows.x[2] = row(bodies, first);
    rows.sum_index = active.data() + first;
    message_block_forward(steps[step].world.block, rows, keep ? row(world, first) : nullptr,
                          world_sum.data(), buffer);
    if (!weights->config.body_updates || last) return;
    std::fill_n(row(body_sum, first), static_cast<size_t>(count * width()), 0.0f);
    MessageBlockRows back;
    back.rows = count;
    back.x[0] = row(reverse, first);
    back.x[1] = row(bodies, first);
    back.x[2] = nodes.data();
    back.x_index[2] = active.data() + first;
    message_block_forward(steps[step].world.block, back, keep ? row(reverse, first) : nullptr,
                          row(body_sum, first), buffer);
    // body nodes share the garment's node network; they have no mesh edges
    MessageBlockRows update;
    update.rows = count;
    update.x[0] = row(bodies, first);
    update.x[1] = row(body_sum, first);
    message_block_forward(steps[step].body.block, update, row(bodies, first), nullptr, buffer);
}

void Engine::Implementation::update_nodes(int group, size_t step, MessageBlockScratch& buffer) {
    const int v0 = first_vertex(group);
    MessageBlockWeights block = steps[step].node.block;
    MessageBlockRows rows;
    rows.rows = first_vertex(group + 1) - v0;
    rows.x[0] = row(nodes, v0);
    rows.x[1] = row(mesh_sum, v0);
    if (block.inputs == 3 && !active.empty())
        rows.x[2] = row(world_sum, v0);
    else
        block.inputs = 2;
    message_block_forward(block, rows, row(nodes, v0), nullptr, buffer);
}

void Engine::Implementation::run_step(int group, size_t step, MessageBlockScratch& buffer) {
    send_edges(group, step, buffer);
    if (weights->config.has_world(static_cast<int>(step)) && !active.empty())
        send_world(group, step, buffer);
    update_nodes(group, step, buffer);
    if (step + 1 < steps.size()) make_products(group, step + 1, buffer);
}

void Engine::Implementation::decode_group(int group, int thread, Points& out) {
    const int v0 = first_vertex(group), count = first_vertex(group + 1) - v0, d = width();
    MessageBlockScratch& buffer = scratch[static_cast<size_t>(thread)];
    float* h1 = decoded[static_cast<size_t>(thread)].data();
    float* h2 = h1 + static_cast<size_t>(group_size * d);
    dense_layer(count, d, d, row(nodes, v0), decoder_w1, decoder_b1, true, h1, buffer);
    dense_layer(count, d, d, h1, decoder_w2, decoder_b2, true, h2, buffer);
    for (int r = 0; r < count; ++r)
        for (int k = 0; k < 3; ++k) {
            float sum = decoder_b3[k];
            for (int i = 0; i < d; ++i) sum += decoder_w3[k * d + i] * h2[r * d + i];
            out(v0 + r, k) = sum;
        }
}

Engine::Engine(std::shared_ptr<const Weights> weights, EngineSettings settings)
    : m_implementation(std::make_unique<Implementation>()) {
    const ModelConfig& config = weights->config;
    if (config.width % 16 != 0 || config.hidden_layers != 2)
        throw ArgumentError("weights of '" + config.variant + "'",
                            "have width " + std::to_string(config.width) + " and " +
                                std::to_string(config.hidden_layers) + " hidden layers",
                            "the engine takes widths that are multiples of 16 and two hidden "
                            "layers; run others with LibTorch");
    m_implementation->weights = std::move(weights);
    m_implementation->settings = settings;
    m_implementation->bind();
}

Engine::~Engine() = default;

const ModelConfig& Engine::config() const {
    return m_implementation->weights->config;
}

void Engine::predict(const ClothGraph& graph, const Features& features, Points& out) {
    Implementation& impl = *m_implementation;
    out.resize(graph.vertex_count, 3);
    if (features.node.rows() != graph.vertex_count || features.edge.rows() != graph.edge_count()) {
        out.setConstant(std::numeric_limits<double>::quiet_NaN());
        return;
    }
    impl.prepare(graph);
    impl.read_features(features);
    const int threads = static_cast<int>(impl.scratch.size());
#pragma omp parallel num_threads(threads)
    {
        const int thread = omp_get_thread_num();
        MessageBlockScratch& buffer = impl.scratch[static_cast<size_t>(thread)];
#pragma omp for schedule(static)
        for (int group = 0; group < impl.groups; ++group) impl.encode_group(group, buffer);
        for (size_t step = 0; step < impl.steps.size(); ++step) {
#pragma omp for schedule(static)
            for (int group = 0; group < impl.groups; ++group) impl.run_step(group, step, buffer);
        }
#pragma omp for schedule(static)
        for (int group = 0; group < impl.groups; ++group) impl.decode_group(group, thread, out);
    }
}

EngineMemory Engine::memory() const {
    const Implementation& impl = *m_implementation;
    EngineMemory memory;
    for (const auto& [name, tensor] : impl.weights->tensors)
        memory.weights += tensor.data.size() * sizeof(float);
    for (const EdgeTable& table : impl.tables)
        memory.topology += sizeof(int) * (table.edges.capacity() + table.receivers.capacity() +
                                          table.senders.capacity() + table.first_row.capacity());
    memory.topology += sizeof(int) * (impl.first_edge.capacity() + impl.first_active.capacity() +
                                      impl.active.capacity());
    for (const Buffer* buffer :
         {&impl.node_in, &impl.edge_in, &impl.world_in, &impl.reverse_in, &impl.body_in,
          &impl.nodes, &impl.edges, &impl.mesh_sum, &impl.world_sum, &impl.world, &impl.reverse,
          &impl.bodies, &impl.body_sum, &impl.product_receiver, &impl.product_sender[0],
          &impl.product_sender[1]})
        memory.workspace += buffer->capacity() * sizeof(float);
    for (const Buffer& buffer : impl.scratch) memory.workspace += buffer.capacity() * sizeof(float);
    for (const Buffer& buffer : impl.decoded) memory.workspace += buffer.capacity() * sizeof(float);
    return memory;
}

}  // namespace cloth
