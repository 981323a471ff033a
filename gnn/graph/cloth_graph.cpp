#include "gnn/graph/cloth_graph.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/vertex_neighbours.h"

namespace cloth {

namespace {

/// splitmix64 (Steele et al. 2014): small, seeded, the same on every platform.
struct SplitMix {
    std::uint64_t state;
    std::uint64_t next() {
        std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
};

void shuffle(std::vector<int>& cards, SplitMix& random) {
    for (int i = static_cast<int>(cards.size()) - 1; i > 0; --i)
        std::swap(cards[static_cast<size_t>(i)], cards[static_cast<size_t>(random.below(i + 1))]);
}

/// One vertex's deck: deals `count` different cards; unused cards come first after a reshuffle.
class Deck {
 public:
    Deck(int first, int size, SplitMix random)
        : m_cards(static_cast<size_t>(size)), m_random(random) {
        std::iota(m_cards.begin(), m_cards.end(), first);
        shuffle(m_cards, m_random);
    }

    void deal(int count, int* out) {
        const int size = static_cast<int>(m_cards.size());
        for (int k = 0; k < count; ++k) out[k] = k < size ? -2 : -1;
        const int left = std::min(size - m_next, count);
        for (int k = 0; k < left; ++k) out[k] = m_cards[static_cast<size_t>(m_next + k)];
        m_next += left;
        const int missing = std::min(count, size) - left;
        if (missing > 0) refill(left, missing, out);
    }

 private:
    void refill(int dealt, int missing, int* out) {
        shuffle(m_cards, m_random);
        // Edges that this step already has go to the end, so that none is taken twice in one step.
        std::stable_partition(m_cards.begin(), m_cards.end(), [&](int card) {
            return std::find(out, out + dealt, card) == out + dealt;
        });
        for (int k = 0; k < missing; ++k) out[dealt + k] = m_cards[static_cast<size_t>(k)];
        m_next = missing;
    }

    std::vector<int> m_cards;
    SplitMix m_random;
    int m_next = 0;
};

Adjacency mesh_adjacency(const Garment& garment) {
    Adjacency neighbours = vertex_neighbours(garment);
    for (std::vector<int>& list : neighbours) std::sort(list.begin(), list.end());
    return neighbours;
}

/// Appends the incoming edges of `nodes`. Returns where each node's begin, and the end.
std::vector<int> append_edges(const Adjacency& neighbours, const std::vector<int>& nodes,
                              ClothGraph& graph) {
    std::vector<int> first_edge = {graph.edge_count()};
    for (const int node : nodes) {
        const std::vector<int>& senders = neighbours[static_cast<size_t>(node)];
        graph.senders.insert(graph.senders.end(), senders.begin(), senders.end());
        graph.receivers.insert(graph.receivers.end(), senders.size(), node);
        first_edge.push_back(graph.edge_count());
    }
    return first_edge;
}

bool uses(const std::vector<int>& levels, int level) {
    return std::find(levels.begin(), levels.end(), level) != levels.end();
}

/// The schedule of a level, dealt over the steps that use it alone.
SamplingSchedule deal_level(const std::vector<int>& first_edge, const GraphSettings& settings,
                            int level) {
    const LevelSchedule& levels = settings.level_schedule;
    if (levels.empty())
        return make_schedule(first_edge, settings.steps, settings.sampled_edges, settings.seed);
    const auto uses_level = [&](const std::vector<int>& step) { return uses(step, level); };
    const auto count = std::count_if(levels.begin(), levels.end(), uses_level);
    const std::uint64_t seed = settings.seed + (static_cast<std::uint64_t>(level) << 32);
    SamplingSchedule dealt =
        make_schedule(first_edge, static_cast<int>(count), settings.sampled_edges, seed);
    if (dealt.edges.empty()) return dealt;
    SamplingSchedule result{dealt.fan_in, std::vector<std::vector<int>>(levels.size())};
    size_t next = 0;
    for (size_t k = 0; k < levels.size(); ++k)
        if (uses_level(levels[k])) result.edges[k] = std::move(dealt.edges[next++]);
    return result;
}

CoarseLevel append_level(const Adjacency& neighbours, const GraphSettings& settings, int level,
                         ClothGraph& graph) {
    CoarseLevel result;
    const LevelSchedule& levels = settings.level_schedule;
    if (std::any_of(levels.begin(), levels.end(),
                    [&](const std::vector<int>& step) { return uses(step, level); }))
        for (int node = 0; node < graph.vertex_count; ++node)
            if (!neighbours[static_cast<size_t>(node)].empty()) result.nodes.push_back(node);
    result.first_edge = append_edges(neighbours, result.nodes, graph);
    result.schedule = deal_level(result.first_edge, settings, level);
    return result;
}

/// Distances at rest. Far vertices may lie in the same place; then a coarse edge has a tenth of a
/// mesh edge's length, because features are divided by it.
VectorX rest_lengths(const Garment& garment, const ClothGraph& graph) {
    VectorX lengths(graph.edge_count());
    const Points& rest = garment.rest().vertices;
    const double least = 0.1 * garment.mean_edge_length();
    for (int e = 0; e < graph.edge_count(); ++e) {
        const double length = (rest.row(graph.senders[static_cast<size_t>(e)]) -
                               rest.row(graph.receivers[static_cast<size_t>(e)]))
                                  .norm();
        lengths[e] = e < graph.first_edge.back() ? length : std::max(length, least);
    }
    return lengths;
}

VectorX cotangent_diagonal(const TriMesh& rest) {
    VectorX diagonal = VectorX::Zero(rest.vertices.rows());
    for (Eigen::Index f = 0; f < rest.faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int i = rest.faces(f, corner);
            const int j = rest.faces(f, (corner + 1) % 3), k = rest.faces(f, (corner + 2) % 3);
            const Vec3 a = rest.vertices.row(j) - rest.vertices.row(i);
            const Vec3 b = rest.vertices.row(k) - rest.vertices.row(i);
            const double cotangent = a.dot(b) / a.cross(b).norm();
            diagonal[j] += 0.5 * cotangent;
            diagonal[k] += 0.5 * cotangent;
        }
    return diagonal;
}

}  // namespace

SamplingSchedule make_schedule(const std::vector<int>& first_edge, int steps, int fan_in,
                               std::uint64_t seed) {
    SamplingSchedule schedule;
    schedule.fan_in = fan_in;
    if (fan_in == 0) return schedule;
    const size_t vertices = first_edge.size() - 1;
    schedule.edges.assign(static_cast<size_t>(steps),
                          std::vector<int>(vertices * static_cast<size_t>(fan_in), -1));
    for (size_t i = 0; i < vertices; ++i) {
        SplitMix random{seed * 0x2545f4914f6cdd1dull + i};
        random.next();
        Deck deck(first_edge[i], first_edge[i + 1] - first_edge[i], random);
        for (auto& step : schedule.edges) deck.deal(fan_in, &step[i * static_cast<size_t>(fan_in)]);
    }
    return schedule;
}

std::uint64_t new_graph_id() {
    static std::atomic<std::uint64_t> next{1};
    return next++;
}

ClothGraph build_cloth_graph(const Garment& garment, const GraphSettings& settings) {
    check_range("GraphSettings.steps", settings.steps, 1, 64);
    check_range("GraphSettings.sampled_edges", settings.sampled_edges, 0, 32);
    check_levels("GraphSettings", settings.steps, settings.pooling, settings.level_schedule);
    ClothGraph graph;
    graph.id = new_graph_id();
    graph.vertex_count = static_cast<int>(garment.vertex_count());
    const Adjacency mesh = mesh_adjacency(garment);
    std::vector<int> all(mesh.size());
    std::iota(all.begin(), all.end(), 0);
    graph.first_edge = append_edges(mesh, all, graph);
    graph.schedule = deal_level(graph.first_edge, settings, 0);
    for (const Adjacency& level :
         build_coarse_levels(mesh, settings.pooling, coarsest_level(settings.level_schedule)))
        graph.coarse.push_back(
            append_level(level, settings, static_cast<int>(graph.coarse.size()) + 1, graph));
    graph.rest_length = rest_lengths(garment, graph);
    graph.laplacian_diagonal = cotangent_diagonal(garment.rest());
    return graph;
}

}  // namespace cloth
