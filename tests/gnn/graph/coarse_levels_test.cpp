#include "gnn/graph/coarse_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/graph/cloth_graph.h"

namespace cloth::coarse_levels_test {
namespace {

using Edges = std::set<std::pair<int, int>>;  ///< the lower node first

Adjacency graph_of(int nodes, const Edges& edges) {
    Adjacency graph(static_cast<size_t>(nodes));
    for (const auto& [a, b] : edges) {
        graph[static_cast<size_t>(a)].push_back(b);
        graph[static_cast<size_t>(b)].push_back(a);
    }
    for (std::vector<int>& list : graph) std::sort(list.begin(), list.end());
    return graph;
}

Edges edges_of(const Adjacency& graph) {
    Edges edges;
    for (int a = 0; a < static_cast<int>(graph.size()); ++a)
        for (const int b : graph[static_cast<size_t>(a)])
            if (a < b) edges.insert({a, b});
    return edges;
}

std::vector<int> nodes_of(const Adjacency& graph) {
    std::vector<int> nodes;
    for (int a = 0; a < static_cast<int>(graph.size()); ++a)
        if (!graph[static_cast<size_t>(a)].empty()) nodes.push_back(a);
    return nodes;
}

Edges path_edges(int first, int count) {
    Edges edges;
    for (int i = first; i + 1 < first + count; ++i) edges.insert({i, i + 1});
    return edges;
}

Adjacency path(int count) {
    return graph_of(count, path_edges(0, count));
}

Adjacency ring(int count) {
    Edges edges = path_edges(0, count);
    edges.insert({0, count - 1});
    return graph_of(count, edges);
}

/// Nodes w y + x, joined to the right and to above.
Adjacency grid(int width, int height) {
    Edges edges;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int i = width * y + x;
            if (x + 1 < width) edges.insert({i, i + 1});
            if (y + 1 < height) edges.insert({i, i + width});
        }
    return graph_of(width * height, edges);
}

Adjacency mesh_graph(const TriMesh& mesh) {
    Edges edges;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int k = 0; k < 3; ++k)
            edges.insert(std::minmax(int{mesh.faces(f, k)}, int{mesh.faces(f, (k + 1) % 3)}));
    return graph_of(static_cast<int>(mesh.vertices.rows()), edges);
}

/// A random sheet that lost faces: it has holes, pieces of all sizes and lone vertices.
Adjacency torn_sheet(unsigned seed, double lost) {
    TriMesh mesh = make_sheet(0.6, 0.5, 500, seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform;
    Eigen::Index kept = 0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        if (uniform(random) >= lost) mesh.faces.row(kept++) = mesh.faces.row(f).eval();
    mesh.faces.conservativeResize(kept, 3);
    return mesh_graph(mesh);
}

/// Slow and obvious.
std::vector<int> centers_by_brute_force(const Adjacency& graph) {
    std::map<int, std::pair<int, int>> best;  // component's lowest node: eccentricity and node
    for (const int node : nodes_of(graph)) {
        const std::vector<int> hops = hop_distances(graph, {node}).hops;
        const int lowest = static_cast<int>(
            std::find_if(hops.begin(), hops.end(), [](int h) { return h >= 0; }) - hops.begin());
        const std::pair<int, int> mine = {*std::max_element(hops.begin(), hops.end()), node};
        const auto [found, is_new] = best.try_emplace(lowest, mine);
        if (!is_new) found->second = std::min(found->second, mine);
    }
    std::vector<int> centers;
    for (const auto& [lowest, candidate] : best) centers.push_back(candidate.second);
    return centers;
}

TEST(GraphCenter, IsInTheMiddleOfAPathAndTheLowestNodeOfARing) {
    EXPECT_EQ(component_centers(path(7)), std::vector<int>{3});
    EXPECT_EQ(component_centers(path(6)), std::vector<int>{2});
    EXPECT_EQ(component_centers(ring(9)), std::vector<int>{0});
    EXPECT_EQ(component_centers(grid(5, 5)), std::vector<int>{12});
}

TEST(GraphCenter, IsThatOfBruteForceInEachComponent) {
    for (unsigned seed = 1; seed <= 6; ++seed)
        for (const double lost : {0.0, 0.2, 0.5}) {
            const Adjacency graph = torn_sheet(seed, lost);
            EXPECT_EQ(component_centers(graph), centers_by_brute_force(graph)) << seed;
        }
    const Adjacency tube = [] {
        Edges edges;
        for (int y = 0; y < 6; ++y)
            for (int x = 0; x < 20; ++x) {
                edges.insert(std::minmax(20 * y + x, 20 * y + (x + 1) % 20));
                if (y < 5) edges.insert({20 * y + x, 20 * (y + 1) + x});
            }
        return graph_of(120, edges);
    }();
    EXPECT_EQ(component_centers(tube), centers_by_brute_force(tube));
}

TEST(HopDistances, CountEdgesToTheNearestSource) {
    const HopDistances distances = hop_distances(path(6), {0, 5});
    EXPECT_EQ(distances.hops, (std::vector<int>{0, 1, 2, 2, 1, 0}));
    EXPECT_EQ(distances.source, (std::vector<int>{0, 0, 0, 1, 1, 1}));
    EXPECT_EQ(hop_distances(Adjacency(2), {0}).hops, (std::vector<int>{0, -1}));
}

TEST(HoodLevels, OfAPathTakeEveryOtherNodeFromTheMiddle) {
    const auto levels = build_coarse_levels(path(9), Pooling::hood, 3);
    EXPECT_EQ(edges_of(levels[0]), (Edges{{0, 2}, {2, 4}, {4, 6}, {6, 8}}));
    EXPECT_EQ(edges_of(levels[1]), (Edges{{0, 4}, {4, 8}}));
    EXPECT_TRUE(edges_of(levels[2]).empty());
}

TEST(HoodLevels, ARingIsClosedBehindItsLastNode) {
    EXPECT_EQ(edges_of(build_coarse_levels(ring(8), Pooling::hood, 1)[0]),
              (Edges{{0, 2}, {2, 4}, {4, 6}, {0, 6}}));
    // Node 5 is the last, and nothing else joins 4 and 6.
    EXPECT_EQ(edges_of(build_coarse_levels(ring(10), Pooling::hood, 1)[0]),
              (Edges{{0, 2}, {2, 4}, {4, 6}, {6, 8}, {0, 8}}));
    // Nodes 2 and 4 are joined over 0 already.
    EXPECT_EQ(edges_of(build_coarse_levels(ring(6), Pooling::hood, 1)[0]), (Edges{{0, 2}, {0, 4}}));
    // Nodes 4 and 5 are neighbours and the last: an edge of the ring remains.
    EXPECT_EQ(edges_of(build_coarse_levels(ring(9), Pooling::hood, 1)[0]),
              (Edges{{0, 2}, {2, 4}, {4, 5}, {5, 7}, {0, 7}}));
}

TEST(HoodLevels, OfAGridAreItsCentreAndEveryOtherRing) {
    const auto levels = build_coarse_levels(grid(5, 5), Pooling::hood, 1);
    // Rings are diamonds around node 12: of 8 nodes at distance 2, of 4 at distance 4.
    EXPECT_EQ(nodes_of(levels[0]),
              (std::vector<int>{0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24}));
    EXPECT_EQ(levels[0][12], (std::vector<int>{2, 6, 8, 10, 14, 16, 18, 22}));
    EXPECT_EQ(levels[0][0], (std::vector<int>{2, 6, 10}));
}

TEST(BistrideLevels, OfAPathAreThoseOfTheSmallerParity) {
    const auto levels = build_coarse_levels(path(9), Pooling::bistride, 2);
    EXPECT_EQ(edges_of(levels[0]), (Edges{{1, 3}, {3, 5}, {5, 7}})) << "four odd, five even";
    EXPECT_EQ(edges_of(levels[1]), (Edges{{3, 7}})) << "from 3: as many even as odd";
}

TEST(BistrideLevels, JoinAllThatIsTwoEdgesApart) {
    const Adjacency fine = grid(5, 5), coarse = build_coarse_levels(fine, Pooling::bistride, 1)[0];
    const std::vector<int> kept = nodes_of(coarse);
    for (const int a : kept) {
        const std::vector<int> hops = hop_distances(fine, {a}).hops;
        for (const int b : kept)
            EXPECT_EQ(edges_of(coarse).count({a, b}) == 1,
                      a < b && hops[static_cast<size_t>(b)] <= 2);
    }
}

class CoarseLevels : public testing::TestWithParam<Pooling> {};

TEST_P(CoarseLevels, LeaveOutWhatIsTooSmall) {
    Edges edges = {{0, 1}, {1, 2}, {0, 2}};  // a triangle, then a lone node and a path
    edges.merge(path_edges(4, 9));
    const auto levels = build_coarse_levels(graph_of(14, edges), GetParam(), 4);
    ASSERT_EQ(levels.size(), 4u);
    for (const int node : nodes_of(levels[0])) EXPECT_GE(node, 4);
    EXPECT_GE(nodes_of(levels[0]).size(), 4u);
    EXPECT_TRUE(nodes_of(levels[3]).empty());
    EXPECT_TRUE(
        nodes_of(build_coarse_levels(graph_of(3, {{0, 1}, {1, 2}, {0, 2}}), GetParam(), 1)[0])
            .empty());
    EXPECT_TRUE(build_coarse_levels({}, GetParam(), 1)[0].empty());
}

TEST_P(CoarseLevels, OfOneComponentDoNotDependOnTheOthers) {
    Edges edges = edges_of(grid(6, 5));
    const auto alone = build_coarse_levels(graph_of(30, edges), GetParam(), 2);
    edges.merge(path_edges(30, 12));
    const auto both = build_coarse_levels(graph_of(42, edges), GetParam(), 2);
    for (size_t level = 0; level < 2; ++level)
        for (size_t node = 0; node < 30; ++node) EXPECT_EQ(both[level][node], alone[level][node]);
}

/// What holds of every level of every mesh.
void expect_sound(const Adjacency& fine, const Adjacency& coarse, const std::vector<int>& pieces) {
    std::map<int, int> first_of;  // a node of the level, per component of the mesh
    for (const int node : nodes_of(coarse)) {
        const std::vector<int>& list = coarse[static_cast<size_t>(node)];
        EXPECT_FALSE(fine[static_cast<size_t>(node)].empty()) << "levels are nested";
        EXPECT_TRUE(std::is_sorted(list.begin(), list.end()));
        const std::vector<int> hops = hop_distances(fine, {node}).hops;
        for (const int other : list) {
            EXPECT_NE(other, node);
            EXPECT_TRUE(edges_of(coarse).count(std::minmax(node, other)));
            EXPECT_LE(hops[static_cast<size_t>(other)], 2);
        }
        const int first =
            first_of.try_emplace(pieces[static_cast<size_t>(node)], node).first->second;
        EXPECT_GE(hop_distances(coarse, {first}).hops[static_cast<size_t>(node)], 0)
            << "a component stays connected";
    }
}

TEST_P(CoarseLevels, AreSoundOnTornSheets) {
    for (unsigned seed = 1; seed <= 3; ++seed)
        for (const double lost : {0.0, 0.25, 0.5}) {
            const Adjacency mesh = torn_sheet(seed, lost);
            const HopDistances distances = hop_distances(mesh, component_centers(mesh));
            const auto levels = build_coarse_levels(mesh, GetParam(), 3);
            for (size_t k = 0; k < levels.size(); ++k) {
                expect_sound(k == 0 ? mesh : levels[k - 1], levels[k], distances.source);
                if (GetParam() != Pooling::hood) continue;
                for (const int node : nodes_of(levels[k]))
                    EXPECT_EQ(distances.hops[static_cast<size_t>(node)] % (2 << k), 0);
            }
        }
}

TEST_P(CoarseLevels, HaveAboutHalfTheNodesAndEdgesOfTwiceTheLength) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        GraphSettings settings;
        settings.steps = 7;
        settings.pooling = GetParam();
        settings.level_schedule = down_and_up(7, 2);
        const Garment garment("sheet", make_sheet(0.8, 0.6, 1500, seed), Fabric::soft_cotton());
        const ClothGraph graph = build_cloth_graph(garment, settings);
        ASSERT_EQ(graph.coarse.size(), 2u);
        double finer_count = graph.vertex_count;
        double finer_length = graph.rest_length.head(graph.first_edge.back()).mean();
        for (const CoarseLevel& level : graph.coarse) {
            const double count = static_cast<double>(level.nodes.size());
            EXPECT_GT(count, 0.4 * finer_count);
            EXPECT_LT(count, 0.6 * finer_count);
            const int first = level.first_edge.front(), edges = level.first_edge.back() - first;
            const double length = graph.rest_length.segment(first, edges).mean();
            // bistride has the edges between neighbours, too
            EXPECT_GT(length, (GetParam() == Pooling::hood ? 1.8 : 1.6) * finer_length);
            EXPECT_LT(length, (GetParam() == Pooling::hood ? 2.1 : 1.9) * finer_length);
            finer_count = count;
            finer_length = length;
        }
    }
}

TEST_P(CoarseLevels, AreTheSameInEveryThread) {
    const Adjacency mesh = torn_sheet(4, 0.1);
    const auto expected = build_coarse_levels(mesh, GetParam(), 3);
    std::array<std::vector<Adjacency>, 4> built;
    std::vector<std::thread> threads;
    for (auto& levels : built)
        threads.emplace_back([&] { levels = build_coarse_levels(mesh, GetParam(), 3); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& levels : built) EXPECT_EQ(levels, expected);
}

INSTANTIATE_TEST_SUITE_P(Poolings, CoarseLevels, testing::Values(Pooling::hood, Pooling::bistride),
                         [](const auto& one) { return pooling_name(one.param); });

TEST(Pooling, HasNames) {
    for (const Pooling pooling : {Pooling::none, Pooling::hood, Pooling::bistride})
        EXPECT_EQ(pooling_named(pooling_name(pooling)), pooling);
    EXPECT_THROW(pooling_named("average"), ArgumentError);
}

TEST(LevelSchedule, GoesDownAndUpAsHood) {
    const LevelSchedule hood = down_and_up(15, 2);
    ASSERT_EQ(hood.size(), 15u);
    const LevelSchedule stages = {{0, 1}, {1, 2}, {2}, {1, 2}, {0, 1}};
    for (size_t k = 0; k < 15; ++k) EXPECT_EQ(hood[k], stages[k / 3]);
    EXPECT_EQ(down_and_up(8, 2),
              (LevelSchedule{{0, 1}, {0, 1}, {1, 2}, {2}, {1, 2}, {1, 2}, {0, 1}, {0, 1}}));
    EXPECT_EQ(down_and_up(3, 1), (LevelSchedule{{0, 1}, {1}, {0, 1}}));
    EXPECT_EQ(coarsest_level(hood), 2);
    EXPECT_EQ(coarsest_level({}), 0);
    EXPECT_THROW(down_and_up(4, 2), ArgumentError);
    EXPECT_THROW(down_and_up(15, 0), ArgumentError);
}

TEST(LevelSchedule, IsRefusedWhereItDoesNotFit) {
    const auto check = [](int steps, Pooling pooling, const LevelSchedule& schedule) {
        check_levels("Test", steps, pooling, schedule);
    };
    EXPECT_NO_THROW(check(2, Pooling::none, {}));
    EXPECT_NO_THROW(check(2, Pooling::hood, {{0, 3}, {6}}));
    EXPECT_THROW(check(2, Pooling::none, {{0}, {0}}), ArgumentError);
    EXPECT_THROW(check(2, Pooling::hood, {{0}}), ArgumentError);
    for (const std::vector<int>& wrong :
         {std::vector<int>{}, {0, 1, 2}, {1, 0}, {1, 1}, {-1}, {7}, {0, 7}})
        EXPECT_THROW(check(2, Pooling::hood, {{0}, wrong}), ArgumentError);
}

TEST(CoarseGraph, HasTheEdgesOfAllLevelsOneBehindTheOther) {
    GraphSettings settings;
    settings.steps = 5;
    settings.sampled_edges = 4;
    settings.pooling = Pooling::hood;
    settings.level_schedule = {{0}, {0, 1}, {3}, {1}, {0}};  // level 2 is in no step
    const Garment garment("sheet", make_sheet(0.5, 0.5, 400), Fabric::soft_cotton());
    const ClothGraph graph = build_cloth_graph(garment, settings);
    const ClothGraph flat = build_cloth_graph(garment, {5, 4, 1});
    EXPECT_EQ(graph.first_edge, flat.first_edge);
    ASSERT_EQ(graph.coarse.size(), 3u);
    EXPECT_TRUE(graph.coarse[1].nodes.empty());
    int first = graph.first_edge.back();
    for (const CoarseLevel& level : graph.coarse) {
        EXPECT_EQ(level.first_edge.front(), first);
        for (size_t i = 0; i < level.nodes.size(); ++i)
            for (int e = level.first_edge[i]; e < level.first_edge[i + 1]; ++e)
                EXPECT_EQ(graph.receivers[static_cast<size_t>(e)], level.nodes[i]);
        first = level.first_edge.back();
    }
    EXPECT_EQ(first, graph.edge_count());
    EXPECT_EQ(graph.rest_length.size(), first);
    EXPECT_GT(graph.rest_length.minCoeff(), 0.0);
}

TEST(CoarseGraph, DealsTheEdgesOfALevelToTheStepsThatUseIt) {
    GraphSettings settings;
    settings.steps = 5;
    settings.sampled_edges = 4;
    settings.pooling = Pooling::bistride;
    settings.level_schedule = down_and_up(5, 2);
    const Garment garment("sheet", make_sheet(0.5, 0.5, 400), Fabric::soft_cotton());
    const ClothGraph graph = build_cloth_graph(garment, settings);
    for (int level = 0; level <= 2; ++level) {
        const SamplingSchedule& schedule = graph.level_sampling(level);
        ASSERT_EQ(schedule.edges.size(), 5u);
        std::set<int> used;
        for (size_t k = 0; k < 5; ++k) {
            const std::vector<int>& levels = settings.level_schedule[k];
            const bool uses = std::find(levels.begin(), levels.end(), level) != levels.end();
            EXPECT_EQ(schedule.edges[k].empty(), !uses);
            used.insert(schedule.edges[k].begin(), schedule.edges[k].end());
        }
        used.erase(-1);
        const int begin =
            level == 0 ? 0 : graph.coarse[static_cast<size_t>(level) - 1].first_edge.front();
        const int end = level == 0 ? graph.first_edge.back()
                                   : graph.coarse[static_cast<size_t>(level) - 1].first_edge.back();
        EXPECT_GE(*used.begin(), begin);
        EXPECT_LT(*used.rbegin(), end);
        EXPECT_GT(static_cast<double>(used.size()), 0.6 * (end - begin));
    }
}

TEST(CoarseGraph, FarVerticesInTheSamePlaceHaveNoEdgeOfLengthZero) {
    // A strip that is folded back onto itself: the second half lies on the first.
    TriMesh strip;
    strip.vertices.resize(18, 3);
    strip.faces.resize(16, 3);
    for (int i = 0; i < 9; ++i) {
        const double x = std::min(i, 8 - i) * 0.02;
        strip.vertices.row(2 * i) << x, 0.0, 0.0;
        strip.vertices.row(2 * i + 1) << x, 0.0, 0.02;
        if (i == 8) break;
        strip.faces.row(2 * i) << 2 * i, 2 * i + 1, 2 * i + 2;
        strip.faces.row(2 * i + 1) << 2 * i + 2, 2 * i + 1, 2 * i + 3;
    }
    GraphSettings settings;
    settings.steps = 1;
    settings.pooling = Pooling::bistride;
    settings.level_schedule = {{0, 1}};
    const Garment garment("strip", strip, Fabric::soft_cotton());
    const ClothGraph graph = build_cloth_graph(garment, settings);
    EXPECT_DOUBLE_EQ(graph.rest_length.minCoeff(), 0.1 * garment.mean_edge_length());
}

}  // namespace
}  // namespace cloth::coarse_levels_test
