#include "gnn/graph/coarse_levels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

static const std::array<std::string, 3> pooling_names = {"none", "hood", "bistride"};

const std::string& pooling_name(Pooling pooling) {
    return pooling_names[static_cast<size_t>(pooling)];
}

Pooling pooling_named(const std::string& name) {
    for (size_t k = 0; k < pooling_names.size(); ++k)
        if (pooling_names[k] == name) return static_cast<Pooling>(k);
    throw ArgumentError("pooling '" + name + "'", "is not known", "use none, hood or bistride");
}

namespace {

void sort_lists(Adjacency& graph) {
    for (std::vector<int>& list : graph) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
}

bool is_joined(const Adjacency& graph, int a, int b) {
    const std::vector<int>& list = graph[static_cast<size_t>(a)];
    return std::binary_search(list.begin(), list.end(), b);
}

/// By one edge or two.
bool is_near(const Adjacency& graph, int a, int b) {
    if (is_joined(graph, a, b)) return true;
    const std::vector<int>& list = graph[static_cast<size_t>(a)];
    return std::any_of(list.begin(), list.end(), [&](int c) { return is_joined(graph, c, b); });
}

/// Keeps the lists sorted.
void join(Adjacency& graph, int a, int b) {
    if (is_joined(graph, a, b)) return;
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
        std::vector<int>& list = graph[static_cast<size_t>(from)];
        list.insert(std::lower_bound(list.begin(), list.end(), to), to);
    }
}

/// One level of HOOD's, from the distances to the centres.
class HoodLevel {
 public:
    HoodLevel(const Adjacency& fine, const std::vector<int>& hops) : m_fine(&fine), m_hops(&hops) {}

    Adjacency build() {
        m_coarse.resize(m_fine->size());
        join_rings();
        join_around_last_nodes();
        join_within_rings();
        return std::move(m_coarse);
    }

 private:
    int hops(int node) const { return (*m_hops)[static_cast<size_t>(node)]; }
    int count() const { return static_cast<int>(m_fine->size()); }
    bool is_odd(int node) const { return hops(node) % 2 == 1; }

    std::vector<int> neighbours(int node, int at_hops) const {
        std::vector<int> result;
        for (const int other : (*m_fine)[static_cast<size_t>(node)])
            if (hops(other) == at_hops) result.push_back(other);
        return result;
    }

    void join_rings() {
        for (int node = 0; node < count(); ++node) {
            if (!is_odd(node)) continue;
            const std::vector<int> outer = neighbours(node, hops(node) + 1);
            for (const int a : neighbours(node, hops(node) - 1))
                for (const int b : outer) {
                    m_coarse[static_cast<size_t>(a)].push_back(b);
                    m_coarse[static_cast<size_t>(b)].push_back(a);
                }
        }
        sort_lists(m_coarse);
    }

    void join_around_last_nodes() {
        std::vector<std::pair<int, int>> missing;
        for (int node = 0; node < count(); ++node) {
            if (!is_odd(node) || !neighbours(node, hops(node) + 1).empty()) continue;
            const std::vector<int> inner = neighbours(node, hops(node) - 1);
            for (size_t i = 0; i < inner.size(); ++i)
                for (size_t j = 0; j < i; ++j)
                    if (!is_near(m_coarse, inner[i], inner[j]))
                        missing.emplace_back(inner[i], inner[j]);
        }
        for (const auto& [a, b] : missing) join(m_coarse, a, b);
    }

    void join_within_rings() {
        for (int node = 0; node < count(); ++node) {
            if (hops(node) < 0 || is_odd(node)) continue;
            for (const int other : neighbours(node, hops(node)))
                if (!is_near(m_coarse, node, other)) join(m_coarse, node, other);
        }
    }

    const Adjacency* m_fine;
    const std::vector<int>* m_hops;
    Adjacency m_coarse;
};

/// Per node whether its ring is kept: those of even or odd distance, per component.
std::vector<char> kept_rings(const HopDistances& distances, size_t components) {
    std::vector<std::array<int, 2>> counts(components, {0, 0});
    const size_t nodes = distances.hops.size();
    const auto parity = [&](size_t i) { return static_cast<size_t>(distances.hops[i] % 2); };
    const auto count = [&](size_t i) -> auto& {
        return counts[static_cast<size_t>(distances.source[i])];
    };
    for (size_t i = 0; i < nodes; ++i)
        if (distances.hops[i] >= 0) ++count(i)[parity(i)];
    std::vector<char> kept(nodes, false);
    for (size_t i = 0; i < nodes; ++i)
        if (distances.hops[i] >= 0) kept[i] = parity(i) == (count(i)[0] <= count(i)[1] ? 0u : 1u);
    return kept;
}

Adjacency bistride_level(const Adjacency& fine, const std::vector<char>& kept) {
    Adjacency coarse(fine.size());
    for (size_t i = 0; i < fine.size(); ++i) {
        if (!kept[i]) continue;
        const auto add = [&](int other) {
            if (kept[static_cast<size_t>(other)] && other != static_cast<int>(i))
                coarse[i].push_back(other);
        };
        for (const int between : fine[i]) {
            add(between);
            for (const int other : fine[static_cast<size_t>(between)]) add(other);
        }
    }
    sort_lists(coarse);
    return coarse;
}

}  // namespace

std::vector<Adjacency> build_coarse_levels(const Adjacency& mesh, Pooling pooling, int levels) {
    std::vector<Adjacency> result;
    if (pooling == Pooling::none) return result;
    result.reserve(static_cast<size_t>(levels));  // `fine` stays where it is
    std::vector<int> centers = component_centers(mesh);
    for (int level = 0; level < levels; ++level) {
        const Adjacency& fine = level == 0 ? mesh : result.back();
        if (pooling == Pooling::hood) {
            result.push_back(HoodLevel(fine, hop_distances(fine, centers).hops).build());
            continue;
        }
        if (level > 0) centers = component_centers(fine);
        result.push_back(
            bistride_level(fine, kept_rings(hop_distances(fine, centers), centers.size())));
    }
    return result;
}

}  // namespace cloth
