#include "gnn/model/engine_workspace.h"

#include <algorithm>

namespace cloth {

EngineWorkspace::EngineWorkspace(const EngineWeights& weights, const EngineTopology& topology,
                                 int threads)
    : width(static_cast<size_t>(weights.config().width)) {
    bool two_levels = false;
    const size_t vertices = static_cast<size_t>(topology.vertices);
    nodes.resize(vertices * width);
    edges.resize(static_cast<size_t>(topology.edges) * width);
    for (int k = 0; k < weights.config().steps; ++k) {
        const std::vector<int>& levels = weights.config().levels(k);
        for (size_t slot = 0; slot < levels.size(); ++slot) {
            AlignedBuffer& products = sender[k % 2][slot];
            const LevelNodes& level = topology.levels[static_cast<size_t>(levels[slot])];
            const size_t count = static_cast<size_t>(level.count) * width;
            if (products.size() < count) products.resize(count);
            two_levels = two_levels || slot > 0;
        }
    }
    if (weights.config().world_every_step)
        for (AlignedBuffer* latents : {&world, &bodies}) latents->resize(vertices * width);
    if (weights.config().body_updates) reverse.resize(vertices * width);
    active.resize(topology.levels.size());
    for (size_t level = 0; level < active.size(); ++level) {
        const size_t count = static_cast<size_t>(topology.levels[level].count);
        active[level].vertices.reserve(count);
        if (level > 0) active[level].rows.reserve(count);
        active[level].first.resize(static_cast<size_t>(topology.groups) + 1);
    }

    const size_t group = static_cast<size_t>(EngineTopology::group_size);
    const auto rows_of = [](const EngineWeights::Encoder& encoder, size_t rows) {
        return rows * static_cast<size_t>(encoder.block.in[0]);
    };
    const int level = weights.config().used_levels().front();  // edges of all have equal features
    const size_t in =
        std::max({rows_of(weights.node_encoder(), group),
                  rows_of(weights.edge_encoder(level), static_cast<size_t>(topology.most_edges)),
                  rows_of(weights.world_encoder(), group), rows_of(weights.body_encoder(), group)});
    scratch.resize(static_cast<size_t>(threads));
    for (Scratch& mine : scratch) {
        mine.in.resize(in);
        for (AlignedBuffer* buffer :
             {&mine.mesh_sum[0], &mine.world_sum, &mine.receiver, &mine.hidden})
            buffer->resize(group * width);
        if (two_levels) mine.mesh_sum[1].resize(group * width);
        if (topology.levels.size() > 1) mine.gathered.resize(group * width);
        if (!weights.config().world_every_step)
            for (AlignedBuffer* buffer : {&mine.world, &mine.bodies}) buffer->resize(group * width);
        if (weights.config().body_updates) mine.body_sum.resize(group * width);
    }
}

size_t EngineWorkspace::bytes() const {
    size_t floats = 0;
    for (const AlignedBuffer* buffer : {&nodes, &edges, &sender[0][0], &sender[0][1], &sender[1][0],
                                        &sender[1][1], &world, &reverse, &bodies})
        floats += buffer->capacity();
    for (const Scratch& mine : scratch)
        for (const AlignedBuffer* buffer :
             {&mine.block, &mine.in, &mine.mesh_sum[0], &mine.mesh_sum[1], &mine.gathered,
              &mine.world_sum, &mine.receiver, &mine.hidden, &mine.world, &mine.bodies,
              &mine.body_sum})
            floats += buffer->capacity();
    size_t numbers = 0;
    for (const Active& level : active)
        numbers += level.vertices.capacity() + level.rows.capacity() + level.first.capacity();
    return sizeof(float) * floats + sizeof(int) * numbers;
}

}  // namespace cloth
