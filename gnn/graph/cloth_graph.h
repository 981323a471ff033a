#pragma once

#include <cstdint>
#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// Which incoming edges a vertex listens to in each message step (FastClothGNN, section 4.1).
///
/// The paper draws the neighbours anew in every evaluation; here the draw is a fixed table, the
/// same in every frame, so that resting cloth does not jitter and results can be repeated. Each
/// vertex deals its edges like a shuffled deck, so all of them are used before one is used again.
struct SamplingSchedule {
    int fan_in = 0;                       ///< edges per vertex and step; 0: all edges, no tables
    std::vector<std::vector<int>> edges;  ///< per step, |V| * fan_in: edge numbers, -1: empty slot
};

struct GraphSettings {
    int steps = 21;          ///< message steps of the network, 1 to 64
    int sampled_edges = 0;   ///< edges per vertex and step, 0 to 32; 0: all
    std::uint64_t seed = 1;  ///< of the sampling schedule
};

/// The garment as a network sees it: directed mesh edges grouped by receiver. Constant per garment.
struct ClothGraph {
    std::uint64_t id = 0;  ///< differs between any two graphs of a process: a key for caches
    int vertex_count = 0;
    std::vector<int> first_edge;  ///< |V| + 1: edges of receiver i are first_edge[i] .. [i + 1]
    std::vector<int> receivers;   ///< |E|, ascending
    std::vector<int> senders;     ///< |E|, ascending within a receiver
    VectorX rest_length;          ///< |E| (m)
    VectorX laplacian_diagonal;   ///< |V|: of the rest mesh's cotangent Laplacian
    SamplingSchedule schedule;

    int edge_count() const { return static_cast<int>(senders.size()); }
};

ClothGraph build_cloth_graph(const Garment& garment, const GraphSettings& settings);

/// The schedule alone; the same for equal arguments on any machine.
SamplingSchedule make_schedule(const std::vector<int>& first_edge, int steps, int fan_in,
                               std::uint64_t seed);

}  // namespace cloth
