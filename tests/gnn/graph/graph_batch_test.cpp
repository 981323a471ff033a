#include "gnn/graph/graph_batch.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/graph/feature_layout.h"

namespace cloth::graph_batch_test {
namespace {

Garment sheet(int vertices) {
    return Garment("sheet", make_sheet(0.6, 0.5, vertices), Fabric::soft_cotton());
}

GraphSettings coarse_settings(int sampled_edges) {
    GraphSettings settings;
    settings.steps = 5;
    settings.sampled_edges = sampled_edges;
    settings.pooling = Pooling::hood;
    settings.level_schedule = down_and_up(5, 2);
    return settings;
}

Features numbered_features(const ClothGraph& graph, float first) {
    Features features;
    const auto fill = [&](Eigen::Index rows, Eigen::Index columns) {
        MatrixF values(rows, columns);
        for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = first++;
        return values;
    };
    features.node = fill(graph.vertex_count, 3);
    features.edge = fill(graph.edge_count(), 2);
    features.world = fill(graph.vertex_count, 2);
    features.body = fill(graph.vertex_count, 1);
    features.world_mask = VectorF::Ones(graph.vertex_count);
    features.any_world = first > 1e4f;
    features.base = fill(graph.vertex_count, 3).cast<double>();
    features.scale = 0.01;
    return features;
}

TEST(GraphBatch, KeepsEachGarmentsEdgesAndJoinsNone) {
    for (const int sampled : {0, 2}) {
        const ClothGraph a = build_cloth_graph(sheet(80), coarse_settings(sampled));
        const ClothGraph b = build_cloth_graph(sheet(200), coarse_settings(sampled));
        const GraphBatch batch({&a, &b, &a});
        const ClothGraph& all = batch.graph();
        EXPECT_EQ(all.vertex_count, 2 * a.vertex_count + b.vertex_count);
        EXPECT_EQ(all.edge_count(), 2 * a.edge_count() + b.edge_count());
        EXPECT_EQ(all.coarse.size(), a.coarse.size());
        EXPECT_EQ(static_cast<int>(all.first_edge.size()), all.vertex_count + 1);
        const auto part_of = [&](int vertex) {
            return vertex < a.vertex_count ? 0 : vertex < a.vertex_count + b.vertex_count ? 1 : 2;
        };
        for (size_t e = 0; e < all.senders.size(); ++e)
            EXPECT_EQ(part_of(all.senders[e]), part_of(all.receivers[e]));
        for (int i = 0; i < all.vertex_count; ++i)
            for (int e = all.first_edge[static_cast<size_t>(i)];
                 e < all.first_edge[static_cast<size_t>(i) + 1]; ++e)
                EXPECT_EQ(all.receivers[static_cast<size_t>(e)], i);
        for (const CoarseLevel& level : all.coarse) {
            ASSERT_EQ(level.first_edge.size(), level.nodes.size() + 1);
            EXPECT_TRUE(std::is_sorted(level.nodes.begin(), level.nodes.end()));
            for (size_t n = 0; n < level.nodes.size(); ++n)
                for (int e = level.first_edge[n]; e < level.first_edge[n + 1]; ++e)
                    EXPECT_EQ(all.receivers[static_cast<size_t>(e)], level.nodes[n]);
        }
        for (size_t level = 0; level <= all.coarse.size(); ++level) {
            const SamplingSchedule& schedule = all.level_sampling(static_cast<int>(level));
            const std::vector<int>& first =
                level == 0 ? all.first_edge : all.coarse[level - 1].first_edge;
            EXPECT_EQ(schedule.fan_in, sampled);
            for (const std::vector<int>& step : schedule.edges)
                for (size_t slot = 0; slot < step.size(); ++slot) {
                    const size_t node = slot / static_cast<size_t>(sampled);
                    if (step[slot] < 0) continue;
                    EXPECT_GE(step[slot], first[node]);
                    EXPECT_LT(step[slot], first[node + 1]);
                }
        }
        EXPECT_NE(all.id, a.id);
        EXPECT_NE(all.id, GraphBatch({&a}).graph().id);
    }
}

TEST(GraphBatch, OfOneIsThatGraph) {
    const ClothGraph a = build_cloth_graph(sheet(120), coarse_settings(2));
    const GraphBatch batch({&a});
    const ClothGraph& all = batch.graph();
    EXPECT_EQ(all.first_edge, a.first_edge);
    EXPECT_EQ(all.senders, a.senders);
    EXPECT_EQ(all.receivers, a.receivers);
    EXPECT_EQ(all.rest_length, a.rest_length);
    EXPECT_EQ(all.laplacian_diagonal, a.laplacian_diagonal);
    for (size_t level = 0; level < a.coarse.size(); ++level) {
        EXPECT_EQ(all.coarse[level].nodes, a.coarse[level].nodes);
        EXPECT_EQ(all.coarse[level].first_edge, a.coarse[level].first_edge);
        EXPECT_EQ(all.coarse[level].schedule.edges, a.coarse[level].schedule.edges);
    }
}

TEST(GraphBatch, PutsFeaturesWhereTheirVerticesAndEdgesAre) {
    const ClothGraph a = build_cloth_graph(sheet(80), coarse_settings(0));
    const ClothGraph b = build_cloth_graph(sheet(200), coarse_settings(0));
    const GraphBatch batch({&a, &b});
    const Features of_a = numbered_features(a, 1.0f), of_b = numbered_features(b, 2e4f);
    Features all;
    batch.gather({&of_a, &of_b}, all);
    EXPECT_TRUE(all.any_world);
    EXPECT_EQ(all.node.bottomRows(b.vertex_count), of_b.node);
    EXPECT_EQ(batch.rows_of(0, all.base), of_a.base);
    EXPECT_EQ(batch.rows_of(1, all.base), of_b.base);
    // An edge is known by its sender among those of its receiver; b has levels of its own.
    for (int e = 0; e < b.edge_count(); ++e) {
        int found = 0;
        for (int g = 0; g < batch.graph().edge_count(); ++g)
            if (all.edge.row(g) == of_b.edge.row(e)) {
                ++found;
                EXPECT_EQ(batch.graph().senders[static_cast<size_t>(g)] - a.vertex_count,
                          b.senders[static_cast<size_t>(e)]);
                EXPECT_EQ(batch.graph().receivers[static_cast<size_t>(g)] - a.vertex_count,
                          b.receivers[static_cast<size_t>(e)]);
                EXPECT_EQ(batch.graph().rest_length[g], b.rest_length[e]);
            }
        EXPECT_EQ(found, 1);
    }
}

TEST(GraphBatch, RefusesWhatDoesNotBelongTogether) {
    const ClothGraph a = build_cloth_graph(sheet(80), coarse_settings(0));
    const ClothGraph sampled = build_cloth_graph(sheet(80), coarse_settings(2));
    const ClothGraph flat = build_cloth_graph(sheet(80), {});
    EXPECT_THROW(GraphBatch({}), ArgumentError);
    EXPECT_THROW(GraphBatch({&a, &sampled}), ArgumentError);
    EXPECT_THROW(GraphBatch({&a, &flat}), ArgumentError);
    const GraphBatch batch({&a, &a});
    Features own = numbered_features(a, 0.0f), other = own, all;
    EXPECT_THROW(batch.gather({&own}, all), ArgumentError);
    other.scale = 0.02;
    EXPECT_THROW(batch.gather({&own, &other}, all), ArgumentError);
    other = own;
    other.node.conservativeResize(own.node.rows() - 1, own.node.cols());
    EXPECT_THROW(batch.gather({&own, &other}, all), ArgumentError);
}

}  // namespace
}  // namespace cloth::graph_batch_test
