#include "gnn/model/engine.h"

#include <omp.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/model/engine_workspace.h"
#include "gnn/model/graph_fit.h"

// The vertices are cut into groups. Within a message step everything that a group writes belongs to
// its own vertices: its incoming edges, its world edges, its node latents. The only thing it reads
// of others are the senders' products B v, which are computed a step ahead into the other of two
// buffers. So groups run in any order on any thread with one barrier per step, and each sum is
// always taken in the same order.
//
// A step on coarse levels does the same with the group's vertices that are in the level: their
// latents are gathered, and products have a row per node of the level. Latents and sums keep the
// numbers of the vertices.

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
        int number;
        int v0, vertices;  ///< first vertex and number
        int w0, active;    ///< first world edge and number
    };
    /// A group's part of some ascending list of rows.
    struct Part {
        int first, count;
        const int* rows;  ///< from the group's first on; null: first, first + 1, ...
    };

    Group group_of(int group) const;
    Part nodes_of(int level, const Group& group) const;
    float* row(AlignedBuffer& buffer, int index) const {
        return buffer.data() + static_cast<size_t>(index) * static_cast<size_t>(m_width);
    }
    /// Where row 0 would be if the group's first row `first` lies at the start of the buffer.
    float* shifted(AlignedBuffer& buffer, int first) const {
        return buffer.data() - static_cast<std::ptrdiff_t>(first) * m_width;
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
    const float* latents_of(const Part& nodes, EngineWorkspace::Scratch& mine) const;
    void send_edges(const Group& group, size_t k, size_t slot,
                    EngineWorkspace::Scratch& mine) const;
    bool send_world(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const;
    void update_bodies(const Group& group, size_t k, const MessageBlockRows& to_garment, bool keep,
                       EngineWorkspace::Scratch& mine) const;
    void update_nodes(const Group& group, size_t k, bool any_world,
                      EngineWorkspace::Scratch& mine) const;
    const std::vector<int>& levels(size_t k) const { return m_config.levels(static_cast<int>(k)); }
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
    for (EngineWorkspace::Active& level : m_work.active) {
        level.vertices.clear();
        level.rows.clear();
    }
    const auto begin_group = [this](size_t group) {
        for (EngineWorkspace::Active& level : m_work.active)
            level.first[group] = static_cast<int>(level.vertices.size());
    };
    for (int i = 0; i < m_topology.vertices; ++i) {
        if (i % EngineTopology::group_size == 0)
            begin_group(static_cast<size_t>(i / EngineTopology::group_size));
        if (m_features.world_mask.size() <= i || m_features.world_mask[i] == 0.0f) continue;
        const int row = static_cast<int>(m_work.active[0].vertices.size());
        m_work.active[0].vertices.push_back(i);
        for (size_t level = 1; level < m_work.active.size(); ++level) {
            if (m_topology.deepest_level[static_cast<size_t>(i)] < static_cast<int>(level)) break;
            m_work.active[level].vertices.push_back(i);
            m_work.active[level].rows.push_back(row);
        }
    }
    begin_group(static_cast<size_t>(m_topology.groups));
}

Engine::Pass::Group Engine::Pass::group_of(int group) const {
    const std::vector<int>& first_active = m_work.active[0].first;
    const int v0 = m_topology.first_vertex(group), w0 = first_active[static_cast<size_t>(group)];
    return {group, v0, m_topology.first_vertex(group + 1) - v0, w0,
            first_active[static_cast<size_t>(group) + 1] - w0};
}

Engine::Pass::Part Engine::Pass::nodes_of(int level, const Group& group) const {
    const LevelNodes& nodes = m_topology.levels[static_cast<size_t>(level)];
    const int first = nodes.first_node[static_cast<size_t>(group.number)];
    return {first, nodes.first_node[static_cast<size_t>(group.number) + 1] - first,
            level == 0 ? nullptr : nodes.vertices.data() + first};
}

/// One after the other.
const float* Engine::Pass::latents_of(const Part& nodes, EngineWorkspace::Scratch& mine) const {
    if (!nodes.rows) return row(m_work.nodes, nodes.first);
    for (int r = 0; r < nodes.count; ++r)
        std::copy_n(row(m_work.nodes, nodes.rows[r]), m_width, row(mine.gathered, r));
    return mine.gathered.data();
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
    for (size_t level = 0; level < m_topology.levels.size(); ++level) {
        const std::vector<int>& first_edge = m_topology.levels[level].first_edge;
        const int e0 = first_edge[static_cast<size_t>(group)];
        const int e1 = first_edge[static_cast<size_t>(group) + 1];
        const EngineWeights::Encoder& encoder = m_weights.edge_encoder(static_cast<int>(level));
        if (encoder.block.width == 0) continue;  // no step uses the level
        encode_rows(encoder, read_rows(m_features.edge, encoder, nullptr, e0, e1, mine.in), e1 - e0,
                    row(m_work.edges, e0), mine);
    }
    if (m_config.world_every_step) encode_world(g, mine);
    make_sender_products(g, 0, mine);
}

void Engine::Pass::encode_world(const Group& group, EngineWorkspace::Scratch& mine) const {
    const int first = group.w0, last = group.w0 + group.active;
    const int* list = m_work.active[0].vertices.data();
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
    for (size_t slot = 0; slot < levels(k).size(); ++slot) {
        const Part nodes = nodes_of(levels(k)[slot], group);
        layer(nodes.count, latents_of(nodes, mine), m_weights.step(k).edges[slot].sender, nullptr,
              false, row(m_work.sender[k % 2][slot], nodes.first), mine);
    }
}

void Engine::Pass::send_edges(const Group& group, size_t k, size_t slot,
                              EngineWorkspace::Scratch& mine) const {
    const int level = levels(k)[slot];
    const Part nodes = nodes_of(level, group);
    const EdgeTable& table = m_topology.table(k, slot);
    const EngineWeights::Edges& weights = m_weights.step(k).edges[slot];
    const int first = table.first_row[static_cast<size_t>(group.number)];
    layer(nodes.count, latents_of(nodes, mine), weights.receiver, nullptr, false,
          mine.receiver.data(), mine);
    AlignedBuffer& sum = mine.mesh_sum[slot];
    std::fill(sum.begin(), sum.end(), 0.0f);
    MessageBlockRows rows;
    rows.rows = table.first_row[static_cast<size_t>(group.number) + 1] - first;
    const bool listed = !table.edges.empty();
    rows.x[0] = listed ? m_work.edges.data() : row(m_work.edges, table.first_edge + first);
    rows.x_index[0] = listed ? table.edges.data() + first : nullptr;
    rows.products = 2;
    rows.p[0] = shifted(mine.receiver, nodes.first);
    rows.sum_index = table.receivers.data() + first;
    rows.p_index[0] =
        table.receiver_rows.empty() ? rows.sum_index : table.receiver_rows.data() + first;
    rows.p[1] = m_work.sender[k % 2][slot].data();
    rows.p_index[1] = table.senders.data() + first;
    rows.sum_scale = static_cast<float>(m_config.message_scale);
    run(weights.block, rows,
        m_config.uses_after(level, static_cast<int>(k)) ? const_cast<float*>(rows.x[0]) : nullptr,
        shifted(sum, group.v0), mine);
}

/// Returns whether there was anything to send.
bool Engine::Pass::send_world(const Group& group, size_t k, EngineWorkspace::Scratch& mine) const {
    if (!m_config.has_world(static_cast<int>(k))) return false;
    const EngineWorkspace::Active& active = m_work.active[static_cast<size_t>(levels(k).front())];
    const int first = active.first[static_cast<size_t>(group.number)];
    MessageBlockRows rows;
    rows.rows = active.first[static_cast<size_t>(group.number) + 1] - first;
    if (rows.rows == 0) return false;
    if (!m_config.world_every_step) encode_world(group, mine);
    const bool keep = m_config.world_every_step && static_cast<int>(k) + 1 < m_config.steps;
    std::fill(mine.world_sum.begin(), mine.world_sum.end(), 0.0f);
    float *world = world_rows(group, mine), *bodies = body_rows(group, mine);
    if (!active.rows.empty()) {  // the list counts from the first of all groups
        world -= static_cast<std::ptrdiff_t>(group.w0) * m_width;
        bodies -= static_cast<std::ptrdiff_t>(group.w0) * m_width;
        rows.x_index[0] = rows.x_index[2] = active.rows.data() + first;
    }
    rows.x[0] = world;
    rows.x[1] = m_work.nodes.data();
    rows.x_index[1] = rows.sum_index = active.vertices.data() + first;
    rows.x[2] = bodies;
    run(m_weights.step(k).world, rows, keep ? world : nullptr, shifted(mine.world_sum, group.v0),
        mine);
    if (m_config.body_updates && static_cast<int>(k) + 1 < m_config.steps)
        update_bodies(group, k, rows, keep, mine);
    return true;
}

/// Body nodes share the garment's node network; they have no mesh edges.
void Engine::Pass::update_bodies(const Group& group, size_t k, const MessageBlockRows& to_garment,
                                 bool keep, EngineWorkspace::Scratch& mine) const {
    std::fill(mine.body_sum.begin(), mine.body_sum.end(), 0.0f);
    const int* list = to_garment.x_index[0];
    float* bodies = const_cast<float*>(to_garment.x[2]);
    float* reverse = list ? m_work.reverse.data() : row(m_work.reverse, group.w0);
    MessageBlockRows back;
    back.rows = to_garment.rows;
    back.x[0] = reverse;
    back.x[1] = bodies;
    back.x_index[0] = back.x_index[1] = list;
    back.x[2] = m_work.nodes.data();
    back.x_index[2] = to_garment.x_index[1];
    run(m_weights.step(k).world, back, keep ? reverse : nullptr, mine.body_sum.data(), mine);
    MessageBlockRows update;
    update.rows = back.rows;
    update.x[0] = bodies;
    update.x_index[0] = list;
    update.x[1 + levels(k).size()] = mine.body_sum.data();
    run(m_weights.step(k).node, update, bodies, nullptr, mine);
}

void Engine::Pass::update_nodes(const Group& group, size_t k, bool any_world,
                                EngineWorkspace::Scratch& mine) const {
    const Part nodes = nodes_of(levels(k).front(), group);
    const auto first_row = [&](AlignedBuffer& sums) {
        return nodes.rows ? shifted(sums, group.v0) : sums.data();
    };
    float* latents = nodes.rows ? m_work.nodes.data() : row(m_work.nodes, group.v0);
    MessageBlockRows rows;
    rows.rows = nodes.count;
    rows.x[0] = latents;
    size_t input = 1;
    for (size_t slot = 0; slot < levels(k).size(); ++slot)
        rows.x[input++] = first_row(mine.mesh_sum[slot]);
    if (any_world) rows.x[input] = first_row(mine.world_sum);
    std::fill(std::begin(rows.x_index), std::end(rows.x_index), nodes.rows);
    run(m_weights.step(k).node, rows, latents, nullptr, mine);
}

void Engine::Pass::step(int group, size_t k, EngineWorkspace::Scratch& mine) const {
    const Group g = group_of(group);
    for (size_t slot = 0; slot < levels(k).size(); ++slot) send_edges(g, k, slot, mine);
    const bool any_world = send_world(g, k, mine);
    update_nodes(g, k, any_world, mine);
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
    m_topology = std::make_unique<Topology>(graph, config());
    m_workspace = std::make_unique<Workspace>(*m_weights, *m_topology, threads);
}

void Engine::predict(const ClothGraph& graph, const Features& features, Points& out) {
    out.resize(graph.vertex_count, 3);
    const bool is_known = m_topology && m_topology->graph_id == graph.id;
    if ((!is_known && !is_graph_of(graph, config())) ||
        !are_features_of(features, graph, config())) {
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
