#pragma once

#include <cstdint>
#include <vector>

#include "data/core/garment.h"
#include "gnn/graph/level_schedule.h"

namespace cloth {

/// Which incoming edges a vertex listens to in each message step (FastClothGNN, section 4.1).
///
/// The paper draws the neighbours anew in every evaluation; here the draw is a fixed table, the
/// same in every frame, so that resting cloth does not jitter and results can be repeated. Each
/// vertex deals its edges like a shuffled deck, so all of them are used before one is used again.
struct SamplingSchedule {
    int fan_in = 0;                       ///< edges per vertex and step; 0: all edges, no tables
    std::vector<std::vector<int>> edges;  ///< per step, |V| * fan_in: edge numbers, -1: empty slot;
                                          ///< none for a step that does not use the level
};

struct GraphSettings {
    int steps = 21;                     ///< message steps of the network, 1 to 64
    int sampled_edges = 0;              ///< edges per vertex and step, 0 to 32; 0: all
    std::uint64_t seed = 1;             ///< of the sampling schedule
    Pooling pooling = Pooling::none;    ///< how coarse levels are made, if there are any
    LevelSchedule level_schedule = {};  ///< which levels a step uses; without pooling: none
};

/// Some of the vertices, and longer edges between them. They lie behind those of the mesh and of
/// the finer levels: edges of receiver nodes[i] have the numbers first_edge[i] .. [i + 1].
struct CoarseLevel {
    std::vector<int> nodes;       ///< |N|, ascending: vertices that have an edge in this level
    std::vector<int> first_edge;  ///< |N| + 1
    SamplingSchedule schedule;    ///< |N| * fan_in per step that uses the level
};

/// The garment as a network sees it: directed edges grouped by receiver. Constant per garment.
struct ClothGraph {
    std::uint64_t id = 0;  ///< differs between any two graphs of a process: a key for caches
    int vertex_count = 0;
    std::vector<int> first_edge;  ///< |V| + 1: mesh edges of receiver i: first_edge[i] .. [i + 1]
    std::vector<int> receivers;   ///< |E| of all levels, ascending within a level
    std::vector<int> senders;     ///< |E|, ascending within a receiver
    VectorX rest_length;          ///< |E| (m)
    VectorX laplacian_diagonal;   ///< |V|: of the rest mesh's cotangent Laplacian
    SamplingSchedule schedule;    ///< of mesh edges
    std::vector<CoarseLevel> coarse;  ///< levels 1, 2, ...; one that no step uses is empty

    const SamplingSchedule& level_sampling(int level) const {
        return level == 0 ? schedule : coarse[static_cast<size_t>(level) - 1].schedule;
    }
    int edge_count() const { return static_cast<int>(senders.size()); }
};

/// @throws ArgumentError if a setting is out of range
ClothGraph build_cloth_graph(const Garment& garment, const GraphSettings& settings);

/// One that no other graph of the process has.
std::uint64_t new_graph_id();

/// The schedule alone; the same for equal arguments on any machine.
SamplingSchedule make_schedule(const std::vector<int>& first_edge, int steps, int fan_in,
                               std::uint64_t seed);

}  // namespace cloth
