#include "gnn/model/engine.h"

#include <omp.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/model/engine_workspace.h"

// The vertices are cut into groups. Within a message step everything that a group writes belongs to
// its own vertices: its incoming edges, its world edges, its node latents. The only thing it reads
// of others are the senders' products B v, which are computed a step ahead into the other of two
// buffers. So groups run in any order on any thread with one barrier per step, and each sum is
// always taken in the same order.

namespace cloth {

struct Engine::Topology : EngineTopology {
    using EngineTopology::EngineTopology;
};

struct Engine::Workspace : EngineWorkspace {
    using EngineWorkspace::EngineWorkspace;
};

namespace {

void normalise_row(const MatrixF& features, Eigen::Index from,
                   const EngineWeights::Statistics& statistics, float* to) {
    for (Eigen::Index c = 0; c < features.cols(); ++c)
        to[c] = (features(from, c) - statistics.mean[c]) * statistics.inverse_deviation[c];
}

/// Rows [first, last) of the features, or those of a list, normalised and filled up with zeros.
const float* read_rows(const MatrixF& features, const EngineWeights::Encoder& encoder,
                       const int* list, int first, int last, AlignedBuffer& to) {
    const int wide = encoder.block.in[0], columns = static_cast<int>(features.cols());
    for (int r = first; r < last; ++r) {
        float* row = to.data() + static_cast<size_t>(r - first) * static_cast<size_t>(wide);
        normalise_row(features, list ? list[r] : r, encoder.statistics, row);
        std::fill(row + columns, row + wide, 0.0f);
    }
    return to.data();
}

/// World edges seen from the body: their relative vectors change sign.
void reverse_rows(const EngineWeights& weights, const MatrixF& features, const int* list, int first,
                  int last, AlignedBuffer& rows) {
    const EngineWeights::Encoder& encoder = weights.world_encoder();
    const int wide = encoder.block.in[0];
    for (int r = first; r < last; ++r) {
        float* row = rows.data() + static_cast<size_t>(r - first) * static_cast<size_t>(wide);
        for (const int k : weights.relative_columns())
            row[k] = (-features(list[r], k) - encoder.statistics.mean[k]) *
                     encoder.statistics.inverse_deviation[k];
    }
}

}  // namespace

/// One evaluation: what every thread does for every group.
class Engine::Pass {
 public:
    Pass(const Engine& engine, const Features& features, Points& out)
        : m_weights(*engine.m_weights),
          m_config(m_weights.config()),
          m_topology(*engine.m_topology),
          m_work(*engine.m_workspace),
          m_features(features),
          m_out(out),
          m_instructions(engine.m_settings.instructions),
          m_width(m_config.width) {}

    void find_active();
    void encode(int group, EngineWorkspace::Scratch& mine) const;
    void step(int group, size_t k, EngineWorkspace::Scratch& mine) const;
    void decode(int group, EngineWorkspace::Scratch& mine) const;

 private:
    struct Group {
        int v0, vertices;  ///< first vertex and number
        int w0, active;    ///< first world edge and number
    };

    Group group_of(int group) const;
    float* row(AlignedBuffer& buffer, int index) const {
        return buffer.data() + static_cast<size_t>(index) * static_cast<size_t>(m_width);
    }
    float* world_rows(const Group& group, EngineWorkspace::Scratch& mine) const {
        return m_config.world_every_step ? row(m_work.world, group.w0) : mine.world.data();
    }
    float* body_rows(const Group& group, EngineWorkspace::Scratch& mine) const {
        return m_config.world_every_step ? row(m_work.bodies, group.w0) : mine.bodies.data();
    }
    void run(const MessageBlockWeights& weights, const MessageBlockRows& rows, float* out,
             float* sum, EngineWorkspace::Scratch& mine) const {
        message_block_forward(weights, rows, out, sum, mine.block, m_instructions);
    }
    void layer(int rows, const float* x, const Panels& panels, const float* bias, bool with_relu,
               float* y, EngineWorkspace::Scratch& mine) const {
        dense_layer(rows, m_width, m_width, x, panels, bias, with_relu, y, mine.block,
                    m_instructions);
    }
    void encode_rows(const EngineWeights::Encoder& encoder, const float* in, int count, float* to,
                     EngineWorkspace::Scratch& mine) const;
    void encode_world(const Group& group, EngineWorkspace::Scratch& mine) const;
    void send_edges(int group, size_t k, EngineWorkspace::Scratch& mine) const;
    void send_world(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const;
    void update_bodies(const Group& group, size_t k, bool keep,
                       EngineWorkspace::Scratch& mine) const;
    void update_nodes(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const;
    void make_sender_products(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const;

    const EngineWeights& m_weights;
    const ModelConfig& m_config;
    const EngineTopology& m_topology;
    EngineWorkspace& m_work;
    const Features& m_features;
    Points& m_out;
    const Instructions m_instructions;
    const int m_width;
};

void Engine::Pass::find_active() {
    m_work.active.clear();
    for (int i = 0; i < m_topology.vertices; ++i) {
        if (i % EngineTopology::group_size == 0)
            m_work.first_active[static_cast<size_t>(i / EngineTopology::group_size)] =
                static_cast<int>(m_work.active.size());
        if (m_features.world_mask.size() > i && m_features.world_mask[i] != 0.0f)
            m_work.active.push_back(i);
    }
    m_work.first_active.back() = static_cast<int>(m_work.active.size());
}

Engine::Pass::Group Engine::Pass::group_of(int group) const {
    const int v0 = m_topology.first_vertex(group),
              w0 = m_work.first_active[static_cast<size_t>(group)];
    return {v0, m_topology.first_vertex(group + 1) - v0, w0,
            m_work.first_active[static_cast<size_t>(group) + 1] - w0};
}

void Engine::Pass::encode_rows(const EngineWeights::Encoder& encoder, const float* in, int count,
                               float* to, EngineWorkspace::Scratch& mine) const {
    MessageBlockRows rows;
    rows.rows = count;
    rows.x[0] = in;
    std::fill_n(to, static_cast<size_t>(count) * static_cast<size_t>(m_width), 0.0f);
    run(encoder.block, rows, nullptr, to, mine);
}

void Engine::Pass::encode(int group, EngineWorkspace::Scratch& mine) const {
    const Group g = group_of(group);
    encode_rows(m_weights.node_encoder(),
                read_rows(m_features.node, m_weights.node_encoder(), nullptr, g.v0,
                          g.v0 + g.vertices, mine.in),
                g.vertices, row(m_work.nodes, g.v0), mine);
    const int e0 = m_topology.first_edge[static_cast<size_t>(group)];
    const int e1 = m_topology.first_edge[static_cast<size_t>(group) + 1];
    encode_rows(m_weights.edge_encoder(),
                read_rows(m_features.edge, m_weights.edge_encoder(), nullptr, e0, e1, mine.in),
                e1 - e0, row(m_work.edges, e0), mine);
    if (m_config.world_every_step) encode_world(g, mine);
    make_sender_products(g, 0, mine);
}

void Engine::Pass::encode_world(const Group& group, EngineWorkspace::Scratch& mine) const {
    const int first = group.w0, last = group.w0 + group.active;
    const int* list = m_work.active.data();
    encode_rows(m_weights.body_encoder(),
                read_rows(m_features.body, m_weights.body_encoder(), list, first, last, mine.in),
                group.active, body_rows(group, mine), mine);
    read_rows(m_features.world, m_weights.world_encoder(), list, first, last, mine.in);
    encode_rows(m_weights.world_encoder(), mine.in.data(), group.active, world_rows(group, mine),
                mine);
    if (!m_config.body_updates) return;
    reverse_rows(m_weights, m_features.world, list, first, last, mine.in);
    encode_rows(m_weights.world_encoder(), mine.in.data(), group.active, row(m_work.reverse, first),
                mine);
}

void Engine::Pass::make_sender_products(const Group& group, size_t k,
                                        EngineWorkspace::Scratch& mine) const {
    layer(group.vertices, row(m_work.nodes, group.v0), m_weights.step(k).sender, nullptr, false,
          row(m_work.sender[k % 2], group.v0), mine);
}

void Engine::Pass::send_edges(int group, size_t k, EngineWorkspace::Scratch& mine) const {
    const Group g = group_of(group);
    const EdgeTable& table = m_topology.table(k);
    const int first = table.first_row[static_cast<size_t>(group)];
    layer(g.vertices, row(m_work.nodes, g.v0), m_weights.step(k).receiver, nullptr, false,
          mine.receiver.data(), mine);
    std::fill(mine.mesh_sum.begin(), mine.mesh_sum.end(), 0.0f);
    // the group's rows of these two lie in scratch: counted from its first vertex
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(g.v0) * m_width;
    MessageBlockRows rows;
    rows.rows = table.first_row[static_cast<size_t>(group) + 1] - first;
    rows.x[0] = table.edges.empty() ? row(m_work.edges, first) : m_work.edges.data();
    rows.x_index[0] = table.edges.empty() ? nullptr : table.edges.data() + first;
    rows.products = 2;
    rows.p[0] = mine.receiver.data() - offset;
    rows.p_index[0] = rows.sum_index = table.receivers.data() + first;
    rows.p[1] = m_work.sender[k % 2].data();
    rows.p_index[1] = table.senders.data() + first;
    rows.sum_scale = static_cast<float>(m_config.message_scale);
    const bool last = static_cast<int>(k) + 1 == m_config.steps;
    run(m_weights.step(k).edge, rows, last ? nullptr : const_cast<float*>(rows.x[0]),
        mine.mesh_sum.data() - offset, mine);
}

void Engine::Pass::send_world(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const {
    const bool keep = m_config.world_every_step && static_cast<int>(k) + 1 < m_config.steps;
    std::fill(mine.world_sum.begin(), mine.world_sum.end(), 0.0f);
    float* world = world_rows(group, mine);
    MessageBlockRows rows;
    rows.rows = group.active;
    rows.x[0] = world;
    rows.x[1] = m_work.nodes.data();
    rows.x_index[1] = m_work.active.data() + group.w0;
    rows.x[2] = body_rows(group, mine);
    rows.sum_index = m_work.active.data() + group.w0;
    run(m_weights.step(k).world, rows, keep ? world : nullptr,
        mine.world_sum.data() - static_cast<std::ptrdiff_t>(group.v0) * m_width, mine);
    if (m_config.body_updates && static_cast<int>(k) + 1 < m_config.steps)
        update_bodies(group, k, keep, mine);
}

/// Body nodes share the garment's node network; they have no mesh edges.
void Engine::Pass::update_bodies(const Group& group, size_t k, bool keep,
                                 EngineWorkspace::Scratch& mine) const {
    std::fill(mine.body_sum.begin(), mine.body_sum.end(), 0.0f);
    float* bodies = body_rows(group, mine);
    float* reverse = row(m_work.reverse, group.w0);
    MessageBlockRows back;
    back.rows = group.active;
    back.x[0] = reverse;
    back.x[1] = bodies;
    back.x[2] = m_work.nodes.data();
    back.x_index[2] = m_work.active.data() + group.w0;
    run(m_weights.step(k).world, back, keep ? reverse : nullptr, mine.body_sum.data(), mine);
    MessageBlockRows update;
    update.rows = group.active;
    update.x[0] = bodies;
    update.x[2] = mine.body_sum.data();
    run(m_weights.step(k).node, update, bodies, nullptr, mine);
}

void Engine::Pass::update_nodes(const Group& group, size_t k,
                                EngineWorkspace::Scratch& mine) const {
    MessageBlockRows rows;
    rows.rows = group.vertices;
    rows.x[0] = row(m_work.nodes, group.v0);
    rows.x[1] = mine.mesh_sum.data();
    if (group.active > 0 && m_config.has_world(static_cast<int>(k)))
        rows.x[2] = mine.world_sum.data();
    run(m_weights.step(k).node, rows, row(m_work.nodes, group.v0), nullptr, mine);
}

void Engine::Pass::step(int group, size_t k, EngineWorkspace::Scratch& mine) const {
    const Group g = group_of(group);
    const bool has_world = m_config.has_world(static_cast<int>(k));
    send_edges(group, k, mine);
    if (has_world && g.active > 0) {
        if (!m_config.world_every_step) encode_world(g, mine);
        send_world(g, k, mine);
    }
    update_nodes(g, k, mine);
    if (static_cast<int>(k) + 1 < m_config.steps) make_sender_products(g, k + 1, mine);
}

void Engine::Pass::decode(int group, EngineWorkspace::Scratch& mine) const {
    const Group g = group_of(group);
    const EngineWeights::Decoder& decoder = m_weights.decoder();
    float *first = mine.receiver.data(), *second = mine.hidden.data();
    layer(g.vertices, row(m_work.nodes, g.v0), decoder.first, decoder.first_bias, true, first,
          mine);
    layer(g.vertices, first, decoder.hidden, decoder.hidden_bias, true, second, mine);
    for (int r = 0; r < g.vertices; ++r)
        for (int c = 0; c < 3; ++c) {
            float sum = decoder.output_bias[c];
            for (int i = 0; i < m_width; ++i)
                sum += decoder.output[c * m_width + i] * second[r * m_width + i];
            m_out(g.v0 + r, c) = sum;
        }
}

Engine::Engine(std::shared_ptr<const EngineWeights> weights, EngineSettings settings)
    : m_weights(std::move(weights)), m_settings(settings) {
    check_range("EngineSettings.threads", settings.threads, 0, 1024);
    if (!is_supported(settings.instructions))
        throw ArgumentError("instructions", "are not those of this processor",
                            "leave them at best_instructions()");
}

Engine::Engine(const Weights& weights, EngineSettings settings)
    : Engine(std::make_shared<const EngineWeights>(weights), settings) {
}

Engine::~Engine() = default;

const ModelConfig& Engine::config() const {
    return m_weights->config();
}

void Engine::prepare(const ClothGraph& graph) {
    if (m_topology && m_topology->graph_id == graph.id) return;
    const int threads = m_settings.threads > 0 ? m_settings.threads : omp_get_max_threads();
    m_topology = std::make_unique<Topology>(graph, config().sampled_edges != 0);
    m_workspace = std::make_unique<Workspace>(*m_weights, *m_topology, threads);
}

void Engine::predict(const ClothGraph& graph, const Features& features, Points& out) {
    out.resize(graph.vertex_count, 3);
    if (features.node.rows() != graph.vertex_count || features.edge.rows() != graph.edge_count()) {
        out.setConstant(std::numeric_limits<double>::quiet_NaN());
        return;
    }
    prepare(graph);
    Pass pass(*this, features, out);
    pass.find_active();
    const int threads = static_cast<int>(m_workspace->scratch.size()), groups = m_topology->groups;
    const size_t steps = static_cast<size_t>(config().steps);
#pragma omp parallel num_threads(threads)
    {
        auto& mine = m_workspace->scratch[static_cast<size_t>(omp_get_thread_num())];
#pragma omp for schedule(dynamic)
        for (int group = 0; group < groups; ++group) pass.encode(group, mine);
        for (size_t k = 0; k < steps; ++k) {
#pragma omp for schedule(dynamic)
            for (int group = 0; group < groups; ++group) pass.step(group, k, mine);
        }
#pragma omp for schedule(dynamic)
        for (int group = 0; group < groups; ++group) pass.decode(group, mine);
    }
}

EngineMemory Engine::memory() const {
    EngineMemory memory;
    memory.weights = m_weights->bytes();
    if (m_topology) memory.topology = m_topology->bytes();
    if (m_workspace) memory.workspace = m_workspace->bytes();
    return memory;
}

}  // namespace cloth
