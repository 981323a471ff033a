#include "gnn/physics/solver/elimination_tree.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace cloth {

namespace {

std::vector<int> minimum_degree_order(const Graph& graph) {
    const int count = static_cast<int>(graph.size());
    std::vector<Eigen::Triplet<double>> entries;
    for (int node = 0; node < count; ++node) {
        entries.emplace_back(node, node, 1.0);
        for (int other : graph[static_cast<size_t>(node)]) entries.emplace_back(node, other, 1.0);
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::AMDOrdering<int>::PermutationType inverse;
    Eigen::AMDOrdering<int>()(matrix, inverse);
    const auto order = inverse.inverse().eval();
    return {order.indices().data(), order.indices().data() + count};
}

/// Parents before children, read backwards: the depth-first order of a forest.
std::vector<int> postorder(const std::vector<std::vector<int>>& structure) {
    const size_t count = structure.size();
    std::vector<std::vector<int>> children(count);
    std::vector<int> stack, visited;
    for (size_t column = 0; column < count; ++column) {
        const int node = static_cast<int>(column);
        if (structure[column].empty())
            stack.push_back(node);
        else
            children[static_cast<size_t>(structure[column].front())].push_back(node);
    }
    while (!stack.empty()) {
        const int node = stack.back();
        stack.pop_back();
        visited.push_back(node);
        for (int child : children[static_cast<size_t>(node)]) stack.push_back(child);
    }
    std::vector<int> place(count);
    for (size_t k = 0; k < count; ++k)
        place[static_cast<size_t>(visited[k])] = static_cast<int>(count - 1 - k);
    return place;
}

}  // namespace

std::vector<std::vector<int>> factor_structure(const Graph& graph,
                                               const std::vector<int>& position) {
    const size_t count = graph.size();
    std::vector<std::vector<int>> structure(count), children(count);
    std::vector<size_t> node_at(count);
    for (size_t node = 0; node < count; ++node) node_at[static_cast<size_t>(position[node])] = node;
    for (size_t column = 0; column < count; ++column) {
        std::vector<int>& rows = structure[column];
        const int self = static_cast<int>(column);
        for (int other : graph[node_at[column]]) {
            const int row = position[static_cast<size_t>(other)];
            if (row > self) rows.push_back(row);
        }
        for (int child : children[column]) {
            const std::vector<int>& below = structure[static_cast<size_t>(child)];
            rows.insert(rows.end(), below.begin() + 1, below.end());
        }
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        if (!rows.empty()) children[static_cast<size_t>(rows.front())].push_back(self);
    }
    return structure;
}

std::vector<int> elimination_order(const Graph& graph) {
    std::vector<int> position = minimum_degree_order(graph);
    const std::vector<int> place = postorder(factor_structure(graph, position));
    for (int& p : position) p = place[static_cast<size_t>(p)];
    return position;
}

}  // namespace cloth
