#include "gnn/graph/graph_center.h"

#include <algorithm>
#include <utility>

namespace cloth {

HopDistances hop_distances(const Adjacency& graph, const std::vector<int>& sources) {
    HopDistances result{std::vector<int>(graph.size(), -1), std::vector<int>(graph.size(), -1)};
    std::vector<int> queue;
    for (const int node : sources) {
        result.hops[static_cast<size_t>(node)] = 0;
        result.source[static_cast<size_t>(node)] = static_cast<int>(queue.size());
        queue.push_back(node);
    }
    for (size_t next = 0; next < queue.size(); ++next) {
        const size_t from = static_cast<size_t>(queue[next]);
        for (const int to : graph[from]) {
            int& hops = result.hops[static_cast<size_t>(to)];
            if (hops >= 0) continue;
            hops = result.hops[from] + 1;
            result.source[static_cast<size_t>(to)] = result.source[from];
            queue.push_back(to);
        }
    }
    return result;
}

namespace {

/// Finds the centre of a component without a search from each of its nodes. A search from w bounds
/// the eccentricity of any other node v from below by d(v, w) and by e(w) - d(v, w) (Takes and
/// Kosters 2013, Computing the Eccentricity Distribution of Large Graphs); most nodes are ruled out
/// by a few searches from the rim.
class CenterSearch {
 public:
    explicit CenterSearch(const Adjacency& graph)
        : m_graph(&graph),
          m_hops(graph.size(), -1),
          m_bound(graph.size(), 0),
          m_searched(graph.size(), false) {}

    /// @param component  all its nodes, ascending
    int center_of(const std::vector<int>& component) {
        Candidate best{static_cast<int>(component.size()), component.front()};
        for (;;) {
            const Candidate next = most_promising(component);
            if (!(next < best)) return best.second;
            int farthest = next.second;
            for (int end = 0; end < 2 && !m_searched[static_cast<size_t>(farthest)]; ++end) {
                const int from = farthest;
                farthest = search(from, component);
                best = std::min(best, {m_hops[static_cast<size_t>(farthest)], from});
            }
        }
    }

 private:
    using Candidate = std::pair<int, int>;  ///< (bound of) its eccentricity, and the node

    Candidate most_promising(const std::vector<int>& component) const {
        Candidate best{static_cast<int>(component.size()), component.back()};
        for (const int node : component)
            if (!m_searched[static_cast<size_t>(node)])
                best = std::min(best, {m_bound[static_cast<size_t>(node)], node});
        return best;
    }

    /// Breadth first; returns a farthest node.
    int search(int from, const std::vector<int>& component) {
        for (const int node : component) m_hops[static_cast<size_t>(node)] = -1;
        m_hops[static_cast<size_t>(from)] = 0;
        m_searched[static_cast<size_t>(from)] = true;
        m_queue.assign(1, from);
        for (size_t next = 0; next < m_queue.size(); ++next) {
            const int node = m_queue[next];
            for (const int to : (*m_graph)[static_cast<size_t>(node)]) {
                int& hops = m_hops[static_cast<size_t>(to)];
                if (hops >= 0) continue;
                hops = m_hops[static_cast<size_t>(node)] + 1;
                m_queue.push_back(to);
            }
        }
        const int eccentricity = m_hops[static_cast<size_t>(m_queue.back())];
        for (const int node : m_queue) {
            const int hops = m_hops[static_cast<size_t>(node)];
            int& bound = m_bound[static_cast<size_t>(node)];
            bound = std::max({bound, hops, eccentricity - hops});
        }
        return m_queue.back();
    }

    const Adjacency* m_graph;
    std::vector<int> m_hops, m_bound, m_queue;
    std::vector<char> m_searched;
};

}  // namespace

std::vector<int> component_centers(const Adjacency& graph) {
    CenterSearch search(graph);
    std::vector<char> seen(graph.size(), false);
    std::vector<int> centers;
    for (size_t first = 0; first < graph.size(); ++first) {
        if (seen[first] || graph[first].empty()) continue;
        std::vector<int> component = {static_cast<int>(first)};
        seen[first] = true;
        for (size_t next = 0; next < component.size(); ++next)
            for (const int to : graph[static_cast<size_t>(component[next])])
                if (!std::exchange(seen[static_cast<size_t>(to)], true)) component.push_back(to);
        std::sort(component.begin(), component.end());
        centers.push_back(search.center_of(component));
    }
    return centers;
}

}  // namespace cloth
