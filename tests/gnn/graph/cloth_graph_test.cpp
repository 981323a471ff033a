#include "gnn/graph/cloth_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "data/authoring/sheet.h"

namespace cloth::cloth_graph_test {
namespace {

Garment sheet() {
    return Garment("sheet", make_sheet(0.3, 0.3, 80), Fabric::soft_cotton());
}

ClothGraph sampled_graph(std::uint64_t seed) {
    return build_cloth_graph(sheet(), {21, 4, seed});
}

int degree(const ClothGraph& graph, int vertex) {
    return graph.first_edge[static_cast<size_t>(vertex) + 1] -
           graph.first_edge[static_cast<size_t>(vertex)];
}

TEST(ClothGraph, HasEveryEdgeInBothDirectionsGroupedByReceiver) {
    const Garment garment = sheet();
    const ClothGraph graph = build_cloth_graph(garment, {});
    std::set<std::pair<int, int>> directed;
    for (int e = 0; e < graph.edge_count(); ++e)
        directed.insert(
            {graph.receivers[static_cast<size_t>(e)], graph.senders[static_cast<size_t>(e)]});
    ASSERT_EQ(directed.size(), 2 * garment.edges().size());
    for (const auto& [a, b] : garment.edges()) {
        EXPECT_TRUE(directed.count({a, b}));
        EXPECT_TRUE(directed.count({b, a}));
    }
    for (int i = 0; i < graph.vertex_count; ++i)
        for (int e = graph.first_edge[static_cast<size_t>(i)];
             e < graph.first_edge[static_cast<size_t>(i) + 1]; ++e)
            EXPECT_EQ(graph.receivers[static_cast<size_t>(e)], i);
}

TEST(ClothGraph, LaplacianDiagonalOfEquilateralTrianglesIsClosedForm) {
    // A hexagon of six equilateral triangles: each spoke weighs (cot 60 + cot 60) / 2.
    TriMesh hexagon;
    hexagon.vertices.setZero(7, 3);
    hexagon.faces.resize(6, 3);
    for (int k = 0; k < 6; ++k) {
        hexagon.vertices.row(k + 1) << std::cos(k * M_PI / 3), 0.0, -std::sin(k * M_PI / 3);
        hexagon.faces.row(k) << 0, k + 1, (k + 1) % 6 + 1;
    }
    const ClothGraph graph =
        build_cloth_graph(Garment("hexagon", hexagon, Fabric::soft_cotton()), {});
    EXPECT_NEAR(graph.laplacian_diagonal[0], 6.0 / std::sqrt(3.0), 1e-12);
}

TEST(SamplingSchedule, DealsDifferentEdgesOfTheRightVertex) {
    const ClothGraph graph = sampled_graph(1);
    ASSERT_EQ(graph.schedule.edges.size(), 21u);
    for (const auto& step : graph.schedule.edges)
        for (int i = 0; i < graph.vertex_count; ++i) {
            const auto begin = step.begin() + 4 * i;
            const std::set<int> dealt(begin, begin + 4);
            const int real = static_cast<int>(
                std::count_if(dealt.begin(), dealt.end(), [](int e) { return e >= 0; }));
            EXPECT_EQ(real, std::min(4, degree(graph, i)));
            for (int e : dealt) {
                if (e < 0) continue;
                EXPECT_EQ(graph.receivers[static_cast<size_t>(e)], i);
            }
        }
}

TEST(SamplingSchedule, UsesAllEdgesWithinTwoStepsOfADegreeUpToEight) {
    const ClothGraph graph = sampled_graph(3);
    std::set<int> used(graph.schedule.edges[0].begin(), graph.schedule.edges[0].end());
    used.insert(graph.schedule.edges[1].begin(), graph.schedule.edges[1].end());
    for (int i = 0; i < graph.vertex_count; ++i) {
        if (degree(graph, i) > 8) continue;
        for (int e = graph.first_edge[static_cast<size_t>(i)];
             e < graph.first_edge[static_cast<size_t>(i) + 1]; ++e)
            EXPECT_TRUE(used.count(e)) << "edge " << e << " of vertex " << i;
    }
}

TEST(SamplingSchedule, IsAFunctionOfTheSeed) {
    EXPECT_EQ(sampled_graph(7).schedule.edges, sampled_graph(7).schedule.edges);
    EXPECT_NE(sampled_graph(7).schedule.edges, sampled_graph(8).schedule.edges);
}

}  // namespace
}  // namespace cloth::cloth_graph_test
