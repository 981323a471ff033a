#include "gnn/train/graph_tables.h"

#include <map>
#include <utility>

namespace cloth {

using torch::Tensor;

Tensor rows_at(const Tensor& matrix, const Tensor& rows) {
    return rows.defined() ? matrix.index_select(0, rows) : matrix;
}

std::vector<int> GraphTables::Level::rows_of(std::vector<int> of) const {
    if (!node_of.empty())
        for (int& vertex : of) vertex = node_of[static_cast<size_t>(vertex)];
    return of;
}

void GraphTables::add_level(int vertex_count, std::vector<int> nodes,
                            const std::vector<int>& first_edge, torch::Device device) {
    const bool is_mesh = levels.empty();
    Level& level = levels.emplace_back();
    level.nodes = is_mesh ? vertex_count : static_cast<int>(nodes.size());
    level.first_edge = first_edge.front();
    level.edges = first_edge.back() - first_edge.front();
    if (!is_mesh) level.node_of.assign(static_cast<size_t>(vertex_count), -1);
    for (size_t row = 0; row < nodes.size(); ++row)
        level.node_of[static_cast<size_t>(nodes[row])] = static_cast<int>(row);
    FusedRows rows;
    rows.rows = level.nodes;
    rows.x_index = std::move(nodes);
    level.update = std::make_shared<const MessageTable>(std::move(rows), device);
    level.vertices = level.update->x_index;
}

/// Messages along edges of `level`, summed per node of the level `onto`.
/// @param sampled  numbers of edges, -1: none; null: all
static FusedRows edge_rows(const ClothGraph& graph, const GraphTables::Level& level,
                           const GraphTables::Level& onto, const std::vector<int>* sampled) {
    FusedRows rows;
    std::vector<int> receivers, senders;
    const auto add = [&](int edge) {
        receivers.push_back(graph.receivers[static_cast<size_t>(edge)]);
        senders.push_back(graph.senders[static_cast<size_t>(edge)]);
    };
    if (sampled) {
        for (const int edge : *sampled) {
            if (edge < 0) continue;
            rows.x_index.push_back(edge - level.first_edge);
            add(edge);
        }
    } else {
        for (int r = 0; r < level.edges; ++r) add(level.first_edge + r);
    }
    rows.rows = static_cast<int>(receivers.size());
    rows.sums = onto.nodes;
    rows.product_index[0] = level.rows_of(receivers);
    rows.product_index[1] = level.rows_of(std::move(senders));
    rows.sum_index = onto.rows_of(std::move(receivers));
    return rows;
}

GraphTables::GraphTables(const ClothGraph& graph, const ModelConfig& config, torch::Device device) {
    add_level(graph.vertex_count, {}, graph.first_edge, device);
    for (const CoarseLevel& coarse : graph.coarse)
        add_level(graph.vertex_count, coarse.nodes, coarse.first_edge, device);
    const auto make = [&](int of, int onto, const std::vector<int>* sampled) {
        FusedRows rows = edge_rows(graph, level(of), level(onto), sampled);
        rows.sum_scale = static_cast<float>(config.message_scale);
        return std::make_shared<const MessageTable>(std::move(rows), device);
    };
    std::map<std::pair<int, int>, std::shared_ptr<const MessageTable>> whole;
    for (int k = 0; k < config.steps; ++k) {
        auto& tables = edge_tables.emplace_back();
        const int onto = config.levels(k).front();
        for (const int of : config.levels(k)) {
            if (config.sampled_edges > 0) {
                const std::vector<int>& sampled =
                    graph.level_sampling(of).edges[static_cast<size_t>(k)];
                tables.push_back(make(of, onto, &sampled));
                continue;
            }
            auto& shared = whole[{of, onto}];  // serves every such step
            if (!shared) shared = make(of, onto, nullptr);
            tables.push_back(shared);
        }
    }
}

void GraphTables::join_levels(const std::vector<std::shared_ptr<const GraphTables>>& parts,
                              RowShifts& row_shifts) {
    std::vector<MessageTable::Shift> vertices(parts.size());
    for (size_t k = 1; k < parts.size(); ++k)
        vertices[k].x = vertices[k - 1].x + parts[k - 1]->level(0).nodes;
    for (size_t number = 0; number < parts[0]->levels.size(); ++number) {
        Level& all = levels.emplace_back();
        std::vector<const MessageTable*> updates;
        for (const auto& part : parts) {
            const Level& own = part->levels[number];
            updates.push_back(own.update.get());
            for (const int row : own.node_of) all.node_of.push_back(row < 0 ? -1 : row + all.nodes);
            all.nodes += own.nodes;
            all.edges += own.edges;
        }
        all.update = std::make_shared<const MessageTable>(updates, vertices, row_shifts);
        all.vertices = all.update->x_index;
    }
}

GraphTables::GraphTables(const std::vector<std::shared_ptr<const GraphTables>>& parts,
                         const ModelConfig& config, torch::Device device) {
    RowShifts row_shifts(device);
    join_levels(parts, row_shifts);
    std::map<const MessageTable*, std::shared_ptr<const MessageTable>> known;
    for (int k = 0; k < config.steps; ++k) {
        auto& tables = edge_tables.emplace_back();
        const std::vector<int>& of_step = config.levels(k);
        for (size_t slot = 0; slot < of_step.size(); ++slot) {
            auto& joined = known[&parts[0]->edge_table(k, slot)];  // serves several steps
            tables.push_back(joined);
            if (joined) continue;
            const int of = of_step[slot], onto = of_step.front();
            std::vector<const MessageTable*> own;
            std::vector<MessageTable::Shift> shifts;
            MessageTable::Shift next;
            for (const auto& part : parts) {
                own.push_back(&part->edge_table(k, slot));
                shifts.push_back(next);
                next.x += part->level(of).edges;
                next.product += part->level(of).nodes;
                next.sum += part->level(onto).nodes;
            }
            joined = std::make_shared<const MessageTable>(own, shifts, row_shifts);
            tables.back() = joined;
        }
    }
}

}  // namespace cloth
