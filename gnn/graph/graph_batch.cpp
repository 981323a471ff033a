#include "gnn/graph/graph_batch.h"

#include <string>

#include "data/core/errors.h"

namespace cloth {

namespace {

const std::vector<int>& first_edges(const ClothGraph& graph, int level) {
    return level == 0 ? graph.first_edge : graph.coarse[static_cast<size_t>(level) - 1].first_edge;
}

bool alike(const SamplingSchedule& a, const SamplingSchedule& b) {
    return a.fan_in == b.fan_in && a.edges.size() == b.edges.size();
}

void check(const std::vector<const ClothGraph*>& graphs) {
    if (graphs.empty())
        throw ArgumentError("batch of graphs", "is empty", "give one graph or more");
    for (const ClothGraph* graph : graphs) {
        bool equal = graph->coarse.size() == graphs.front()->coarse.size();
        for (int level = 0; equal && level <= static_cast<int>(graph->coarse.size()); ++level)
            equal = alike(graph->level_sampling(level), graphs.front()->level_sampling(level));
        if (!equal)
            throw ArgumentError("batch of graphs", "has graphs of different settings",
                                "build all with the settings of one network");
    }
}

void append(const SamplingSchedule& own, int shift, SamplingSchedule& all) {
    all.fan_in = own.fan_in;
    all.edges.resize(own.edges.size());
    for (size_t k = 0; k < own.edges.size(); ++k)
        for (const int edge : own.edges[k]) all.edges[k].push_back(edge < 0 ? -1 : edge + shift);
}

}  // namespace

void GraphBatch::add_level(const std::vector<const ClothGraph*>& graphs, int level) {
    CoarseLevel all;
    all.first_edge = {m_graph.edge_count()};
    for (size_t k = 0; k < graphs.size(); ++k) {
        const ClothGraph& own = *graphs[k];
        Part& part = m_parts[k];
        const std::vector<int>& first = first_edges(own, level);
        part.own_edges.push_back(first.front());
        part.edges_here.push_back(m_graph.edge_count());
        part.edge_counts.push_back(first.back() - first.front());
        const int shift = m_graph.edge_count() - first.front();
        for (size_t i = 1; i < first.size(); ++i) all.first_edge.push_back(first[i] + shift);
        for (int e = first.front(); e < first.back(); ++e) {
            m_graph.receivers.push_back(own.receivers[static_cast<size_t>(e)] + part.first_vertex);
            m_graph.senders.push_back(own.senders[static_cast<size_t>(e)] + part.first_vertex);
        }
        append(own.level_sampling(level), shift, all.schedule);
        if (level == 0) continue;
        for (const int node : own.coarse[static_cast<size_t>(level) - 1].nodes)
            all.nodes.push_back(node + part.first_vertex);
    }
    if (level > 0) {
        m_graph.coarse.push_back(std::move(all));
    } else {
        m_graph.first_edge = std::move(all.first_edge);
        m_graph.schedule = std::move(all.schedule);
    }
}

GraphBatch::GraphBatch(const std::vector<const ClothGraph*>& graphs) {
    check(graphs);
    m_graph.id = new_graph_id();
    for (const ClothGraph* graph : graphs) {
        Part& part = m_parts.emplace_back();
        part.first_vertex = m_graph.vertex_count;
        part.vertices = graph->vertex_count;
        part.edges = graph->edge_count();
        m_graph.vertex_count += graph->vertex_count;
    }
    for (int level = 0; level <= static_cast<int>(graphs.front()->coarse.size()); ++level)
        add_level(graphs, level);
    m_graph.rest_length.resize(m_graph.edge_count());
    m_graph.laplacian_diagonal.resize(m_graph.vertex_count);
    for (size_t k = 0; k < graphs.size(); ++k) {
        const Part& part = m_parts[k];
        m_graph.laplacian_diagonal.segment(part.first_vertex, part.vertices) =
            graphs[k]->laplacian_diagonal;
        for (size_t level = 0; level < part.edge_counts.size(); ++level)
            m_graph.rest_length.segment(part.edges_here[level], part.edge_counts[level]) =
                graphs[k]->rest_length.segment(part.own_edges[level], part.edge_counts[level]);
    }
}

void GraphBatch::gather(const std::vector<const Features*>& features, Features& all) const {
    bool fits = features.size() == m_parts.size();
    for (size_t k = 0; fits && k < m_parts.size(); ++k) {
        const Features &own = *features[k], &first = *features.front();
        fits = own.node.rows() == m_parts[k].vertices && own.edge.rows() == m_parts[k].edges &&
               own.node.cols() == first.node.cols() && own.scale == first.scale;
    }
    if (!fits)
        throw ArgumentError("features of a batch", "are not those of its garments",
                            "give those of each graph, in the order of the graphs, of one network");
    const Features& first = *features.front();
    all.node.resize(m_graph.vertex_count, first.node.cols());
    all.edge.resize(m_graph.edge_count(), first.edge.cols());
    all.world.resize(m_graph.vertex_count, first.world.cols());
    all.body.resize(m_graph.vertex_count, first.body.cols());
    all.world_mask.resize(m_graph.vertex_count);
    all.base.resize(m_graph.vertex_count, 3);
    all.scale = first.scale;
    all.any_world = false;
    for (size_t k = 0; k < m_parts.size(); ++k) {
        const Part& part = m_parts[k];
        const Features& own = *features[k];
        all.node.middleRows(part.first_vertex, part.vertices) = own.node;
        all.world.middleRows(part.first_vertex, part.vertices) = own.world;
        all.body.middleRows(part.first_vertex, part.vertices) = own.body;
        all.world_mask.segment(part.first_vertex, part.vertices) = own.world_mask;
        all.base.middleRows(part.first_vertex, part.vertices) = own.base;
        all.any_world |= own.any_world;
        for (size_t level = 0; level < part.edge_counts.size(); ++level)
            all.edge.middleRows(part.edges_here[level], part.edge_counts[level]) =
                own.edge.middleRows(part.own_edges[level], part.edge_counts[level]);
    }
}

Points GraphBatch::rows_of(size_t k, const Points& all) const {
    return all.middleRows(m_parts[k].first_vertex, m_parts[k].vertices);
}

}  // namespace cloth
