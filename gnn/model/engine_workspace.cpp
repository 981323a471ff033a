#include "gnn/model/engine_workspace.h"

#include <algorithm>

namespace cloth {

EngineWorkspace::EngineWorkspace(const EngineWeights& weights, const EngineTopology& topology,
                                 int threads)
    : width(static_cast<size_t>(weights.config().width)) {
    const size_t vertices = static_cast<size_t>(topology.vertices);
    nodes.resize(vertices * width);
    edges.resize(static_cast<size_t>(topology.edges) * width);
    for (AlignedBuffer& products : sender) products.resize(vertices * width);
    if (weights.config().world_every_step)
        for (AlignedBuffer* latents : {&world, &bodies}) latents->resize(vertices * width);
    if (weights.config().body_updates) reverse.resize(vertices * width);
    active.reserve(vertices);
    first_active.resize(static_cast<size_t>(topology.groups) + 1);

    const size_t group = static_cast<size_t>(EngineTopology::group_size);
    const auto rows_of = [](const EngineWeights::Encoder& encoder, size_t rows) {
        return rows * static_cast<size_t>(encoder.block.in[0]);
    };
    const size_t in =
        std::max({rows_of(weights.node_encoder(), group),
                  rows_of(weights.edge_encoder(), static_cast<size_t>(topology.most_edges)),
                  rows_of(weights.world_encoder(), group), rows_of(weights.body_encoder(), group)});
    scratch.resize(static_cast<size_t>(threads));
    for (Scratch& mine : scratch) {
        mine.in.resize(in);
        for (AlignedBuffer* buffer :
             {&mine.mesh_sum, &mine.world_sum, &mine.receiver, &mine.hidden})
            buffer->resize(group * width);
        if (!weights.config().world_every_step)
            for (AlignedBuffer* buffer : {&mine.world, &mine.bodies}) buffer->resize(group * width);
        if (weights.config().body_updates) mine.body_sum.resize(group * width);
    }
}

size_t EngineWorkspace::bytes() const {
    size_t floats = 0;
    for (const AlignedBuffer* buffer :
         {&nodes, &edges, &sender[0], &sender[1], &world, &reverse, &bodies})
        floats += buffer->capacity();
    for (const Scratch& mine : scratch)
        for (const AlignedBuffer* buffer :
             {&mine.block, &mine.in, &mine.mesh_sum, &mine.world_sum, &mine.receiver, &mine.hidden,
              &mine.world, &mine.bodies, &mine.body_sum})
            floats += buffer->capacity();
    return sizeof(float) * floats + sizeof(int) * (active.capacity() + first_active.capacity());
}

}  // namespace cloth
