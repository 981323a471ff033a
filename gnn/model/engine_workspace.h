#pragma once

#include <vector>

#include "gnn/model/aligned_buffer.h"
#include "gnn/model/engine_topology.h"
#include "gnn/model/engine_weights.h"

namespace cloth {

/// Everything that changes while the engine runs, allocated once per garment.
///
/// Kept over the whole evaluation: node and edge latents, the senders' products, and, if the
/// variant updates them, the latents of world edges and body nodes. What a group of vertices needs
/// only within a step lies in the scratch of the thread that works on it.
struct EngineWorkspace {
    struct Scratch {
        MessageBlockScratch block;                  ///< of the kernels
        AlignedBuffer in;                           ///< normalised features of a group
        AlignedBuffer mesh_sum[2];                  ///< (group x D) per slot of a step
        AlignedBuffer gathered;                     ///< (group x D) nodes of a level
        AlignedBuffer world_sum, receiver, hidden;  ///< (group x D)
        AlignedBuffer world, bodies, body_sum;      ///< (group x D)
    };

    EngineWorkspace(const EngineWeights& weights, const EngineTopology& topology, int threads);

    size_t bytes() const;

    /// World edges of a level's vertices.
    struct Active {
        std::vector<int> vertices;  ///< ascending
        std::vector<int> rows;      ///< which of level 0's they are; empty on level 0
        std::vector<int> first;     ///< per group, and one past the last
    };

    size_t width;
    AlignedBuffer nodes, edges;
    AlignedBuffer sender[2][2];            ///< of even and of odd steps, per slot of a step
    AlignedBuffer world, reverse, bodies;  ///< (|V| x D), only if world messages are sent each step
    std::vector<Active> active;            ///< per level
    std::vector<Scratch> scratch;          ///< per thread
};

}  // namespace cloth
