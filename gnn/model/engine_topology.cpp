#include "gnn/model/engine_topology.h"

#include <algorithm>

namespace cloth {

static EdgeTable make_table(const ClothGraph& graph, const std::vector<int>* sampled) {
    EdgeTable table;
    if (!sampled) {
        table.receivers = graph.receivers;
        table.senders = graph.senders;
        return table;
    }
    for (const int edge : *sampled) {
        if (edge < 0) continue;
        table.edges.push_back(edge);
        table.receivers.push_back(graph.receivers[static_cast<size_t>(edge)]);
        table.senders.push_back(graph.senders[static_cast<size_t>(edge)]);
    }
    for (std::vector<int>* column : {&table.edges, &table.receivers, &table.senders})
        column->shrink_to_fit();
    return table;
}

EngineTopology::EngineTopology(const ClothGraph& graph, bool sampled)
    : graph_id(graph.id),
      vertices(graph.vertex_count),
      edges(graph.edge_count()),
      groups((graph.vertex_count + group_size - 1) / group_size) {
    for (int group = 0; group <= groups; ++group)
        first_edge.push_back(graph.first_edge[static_cast<size_t>(first_vertex(group))]);
    if (sampled)
        for (const std::vector<int>& step : graph.schedule.edges)
            tables.push_back(make_table(graph, &step));
    else
        tables.push_back(make_table(graph, nullptr));
    for (EdgeTable& table : tables)
        for (int group = 0; group <= groups; ++group)
            table.first_row.push_back(
                static_cast<int>(std::lower_bound(table.receivers.begin(), table.receivers.end(),
                                                  first_vertex(group)) -
                                 table.receivers.begin()));
    for (size_t group = 0; group < static_cast<size_t>(groups); ++group)
        most_edges = std::max(most_edges, first_edge[group + 1] - first_edge[group]);
}

int EngineTopology::first_vertex(int group) const {
    return std::min(vertices, group * group_size);
}

size_t EngineTopology::bytes() const {
    size_t count = first_edge.capacity();
    for (const EdgeTable& table : tables)
        count += table.edges.capacity() + table.receivers.capacity() + table.senders.capacity() +
                 table.first_row.capacity();
    return sizeof(int) * count;
}

}  // namespace cloth
