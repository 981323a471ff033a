#include "gnn/graph/cloth_graph.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "data/core/check_range.h"

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

void add_directed_edges(const Garment& garment, ClothGraph& graph) {
    std::vector<std::vector<int>> neighbours(static_cast<size_t>(graph.vertex_count));
    for (const auto& [a, b] : garment.edges()) {
        neighbours[static_cast<size_t>(a)].push_back(b);
        neighbours[static_cast<size_t>(b)].push_back(a);
    }
    graph.first_edge.assign(1, 0);
    for (int i = 0; i < graph.vertex_count; ++i) {
        auto& senders = neighbours[static_cast<size_t>(i)];
        std::sort(senders.begin(), senders.end());
        graph.senders.insert(graph.senders.end(), senders.begin(), senders.end());
        graph.receivers.insert(graph.receivers.end(), senders.size(), i);
        graph.first_edge.push_back(graph.edge_count());
    }
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

ClothGraph build_cloth_graph(const Garment& garment, const GraphSettings& settings) {
    check_range("GraphSettings.steps", settings.steps, 1, 64);
    check_range("GraphSettings.sampled_edges", settings.sampled_edges, 0, 32);
    static std::atomic<std::uint64_t> next_id{1};
    ClothGraph graph;
    graph.id = next_id++;
    graph.vertex_count = static_cast<int>(garment.vertex_count());
    add_directed_edges(garment, graph);
    graph.rest_length.resize(graph.edge_count());
    const Points& rest = garment.rest().vertices;
    for (int e = 0; e < graph.edge_count(); ++e)
        graph.rest_length[e] = (rest.row(graph.senders[static_cast<size_t>(e)]) -
                                rest.row(graph.receivers[static_cast<size_t>(e)]))
                                   .norm();
    graph.laplacian_diagonal = cotangent_diagonal(garment.rest());
    graph.schedule =
        make_schedule(graph.first_edge, settings.steps, settings.sampled_edges, settings.seed);
    return graph;
}

}  // namespace cloth
