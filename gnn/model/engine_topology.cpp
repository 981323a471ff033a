#include "gnn/model/engine_topology.h"

#include <algorithm>
#include <map>

namespace cloth {

static size_t bytes_of(std::initializer_list<const std::vector<int>*> columns) {
    size_t count = 0;
    for (const std::vector<int>* column : columns) count += column->capacity();
    return sizeof(int) * count;
}

/// Of ascending numbers, those below `limit`.
static int count_below(const std::vector<int>& numbers, int limit) {
    return static_cast<int>(std::lower_bound(numbers.begin(), numbers.end(), limit) -
                            numbers.begin());
}

size_t EdgeTable::bytes() const {
    return bytes_of({&edges, &receivers, &senders, &receiver_rows, &first_row});
}

EngineTopology::EngineTopology(const ClothGraph& graph, const ModelConfig& config)
    : graph_id(graph.id),
      vertices(graph.vertex_count),
      edges(graph.edge_count()),
      groups((graph.vertex_count + group_size - 1) / group_size) {
    add_mesh(graph);
    for (const CoarseLevel& level : graph.coarse) add_level(level);
    for (const LevelNodes& level : levels)
        for (size_t group = 0; group < static_cast<size_t>(groups); ++group)
            most_edges =
                std::max(most_edges, level.first_edge[group + 1] - level.first_edge[group]);
    std::map<int, size_t> whole;  // tables of all edges of a level serve every step
    for (int k = 0; k < config.steps; ++k) {
        std::vector<size_t>& slots = table_of.emplace_back();
        for (const int level : config.levels(k)) {
            const auto found = whole.find(level);
            slots.push_back(found != whole.end() ? found->second : tables.size());
            if (found != whole.end()) continue;
            const bool sampled = config.sampled_edges != 0;
            if (!sampled) whole[level] = tables.size();
            add_table(
                graph, level,
                sampled ? &graph.level_sampling(level).edges[static_cast<size_t>(k)] : nullptr);
        }
    }
}

void EngineTopology::add_mesh(const ClothGraph& graph) {
    LevelNodes mesh;
    mesh.count = vertices;
    for (int group = 0; group <= groups; ++group) {
        mesh.first_node.push_back(first_vertex(group));
        mesh.first_edge.push_back(graph.first_edge[static_cast<size_t>(first_vertex(group))]);
    }
    levels.push_back(std::move(mesh));
}

void EngineTopology::add_level(const CoarseLevel& level) {
    LevelNodes nodes;
    nodes.count = static_cast<int>(level.nodes.size());
    nodes.vertices = level.nodes;
    for (int group = 0; group <= groups; ++group) {
        const int first = count_below(level.nodes, first_vertex(group));
        nodes.first_node.push_back(first);
        nodes.first_edge.push_back(level.first_edge[static_cast<size_t>(first)]);
    }
    deepest_level.resize(static_cast<size_t>(vertices), 0);
    for (const int vertex : level.nodes)
        deepest_level[static_cast<size_t>(vertex)] = static_cast<int>(levels.size());
    levels.push_back(std::move(nodes));
}

void EngineTopology::add_table(const ClothGraph& graph, int level,
                               const std::vector<int>* sampled) {
    EdgeTable table;
    const auto add = [&](int edge) {
        table.receivers.push_back(graph.receivers[static_cast<size_t>(edge)]);
        table.senders.push_back(graph.senders[static_cast<size_t>(edge)]);
    };
    const LevelNodes& nodes = levels[static_cast<size_t>(level)];
    table.first_edge = nodes.first_edge.front();
    if (sampled) {
        for (const int edge : *sampled) {
            if (edge < 0) continue;
            table.edges.push_back(edge);
            add(edge);
        }
    } else {
        for (int edge = table.first_edge; edge < nodes.first_edge.back(); ++edge) add(edge);
    }
    for (int group = 0; group <= groups; ++group)
        table.first_row.push_back(count_below(table.receivers, first_vertex(group)));
    if (level > 0) {
        table.receiver_rows = table.receivers;
        for (std::vector<int>* column : {&table.receiver_rows, &table.senders})
            for (int& vertex : *column) vertex = count_below(nodes.vertices, vertex);
    }
    for (std::vector<int>* column :
         {&table.edges, &table.receivers, &table.senders, &table.receiver_rows})
        column->shrink_to_fit();
    tables.push_back(std::move(table));
}

int EngineTopology::first_vertex(int group) const {
    return std::min(vertices, group * group_size);
}

size_t EngineTopology::bytes() const {
    size_t sum = bytes_of({&deepest_level});
    for (const LevelNodes& level : levels)
        sum += bytes_of({&level.vertices, &level.first_node, &level.first_edge});
    for (const EdgeTable& table : tables) sum += table.bytes();
    return sum;
}

}  // namespace cloth
