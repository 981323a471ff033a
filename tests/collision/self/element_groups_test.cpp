#include "collision/self/element_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "collision/self/offset_regions.h"
#include "tests/collision/self/self_scenes.h"

namespace cloth::element_groups_test {
namespace {

using namespace test;

/// Of some moments of the step: no less than that of all of it.
double distance_on_the_way(const ElementPair& pair, const Points& x, const Points& motion) {
    double least = std::numeric_limits<double>::infinity();
    for (const double time : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        std::array<Vec3, 4> corners = corners_of(pair, x);
        for (size_t k = 0; k < 4; ++k) corners[k] += time * motion.row(pair.vertex[k]).transpose();
        least = std::min(least, std::sqrt(closest_points(pair.edges, corners).squared));
    }
    return least;
}

/// No neighbour of the face is nearer to the vertex. Edges are not told apart by that.
bool is_foremost(const OffsetRegions& regions, const ElementPair& pair, const ClosestPoints& points,
                 const Points& x) {
    return pair.edges || regions.contain(pair, points, x);
}

struct Roll {
    Garment garment = strip();
    Points x = wound(garment.rest().vertices, 5e-3);
    Points motion = 2e-3 * Points::Ones(x.rows(), 3);

    Roll() {
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            motion.row(i) *= std::sin(30.0 * garment.rest().vertices(i, 0));
    }
    /// Elements that are visited, each once.
    std::set<Key> visited(ElementGroups::Which which, double reach) const {
        ElementGroups groups(garment, which);
        groups.find(x, motion, reach, 1);
        std::set<Key> keys;
        for (int k = 0; k < groups.found(); ++k)
            groups.visit(k, [&](const ElementPair& pair, int, int) {
                EXPECT_TRUE(keys.insert(key_of(pair)).second) << "a pair comes twice";
            });
        return keys;
    }
};

}  // namespace

TEST(ElementGroups, MissNothingThatComesNear) {
    const Roll roll;
    const double reach = 6e-3;
    const std::set<Key> near = roll.visited(ElementGroups::Which::near, reach);
    const std::set<Key> facing = roll.visited(ElementGroups::Which::facing, reach);
    const OffsetRegions regions(roll.garment);
    size_t expected = 0, all = 0;
    visit_all(roll.garment, [&](const ElementPair& pair) {
        ++all;
        if (distance_on_the_way(pair, roll.x, roll.motion) > reach) return;
        ++expected;
        EXPECT_TRUE(near.count(key_of(pair)));
        const ClosestPoints points = closest_points(pair.edges, corners_of(pair, roll.x));
        const bool faces = points.facing && is_foremost(regions, pair, points, roll.x);
        EXPECT_TRUE(!faces || facing.count(key_of(pair)));
    });
    EXPECT_GT(expected, 1000u);
    EXPECT_LT(near.size(), all / 20);
    EXPECT_LT(4 * facing.size(), 3 * near.size());
}

// However the layers lie, crumpled ones too, and wherever in space.
TEST(ElementGroups, MissNothingThatFacesInItsRegion) {
    for (int seed = 0; seed < 12; ++seed) {
        Roll roll;
        std::mt19937 random(static_cast<unsigned>(seed));
        for (Eigen::Index i = 0; i < roll.x.size(); ++i)
            roll.x.data()[i] += seed % 4 * 1e-3 * (1e-9 * (random() % 2000000000) - 1.0);
        if (seed % 3 == 2) roll.x.rowwise() += Eigen::RowVector3d(300.0, -20.0, 7.0);
        const double reach = 6e-3;
        const OffsetRegions regions(roll.garment);
        const std::set<Key> facing = roll.visited(ElementGroups::Which::facing, reach);
        size_t expected = 0, vertices = 0;
        visit_all(roll.garment, [&](const ElementPair& pair) {
            const ClosestPoints points = closest_points(pair.edges, corners_of(pair, roll.x));
            if (!points.facing || !is_foremost(regions, pair, points, roll.x)) return;
            if (distance_on_the_way(pair, roll.x, roll.motion) > reach) return;
            ++expected;
            if (!pair.edges) ++vertices;
            EXPECT_TRUE(facing.count(key_of(pair)));
        });
        EXPECT_GT(vertices, 300u);
        EXPECT_GT(expected, 500u);
        if (seed % 4 > 0) continue;
        const auto is_vertex = [](const Key& key) { return key[0] == 0; };
        EXPECT_LT(std::count_if(facing.begin(), facing.end(), is_vertex),
                  static_cast<std::ptrdiff_t>(3 * vertices));
    }
}

TEST(ElementGroups, PairsAreOfTheFacesThatTheyAreShownWith) {
    const Roll roll;
    const SelfElements elements(roll.garment);
    const auto has = [](const auto& list, int element) {
        return std::find(list.begin(), list.end(), element) != list.end();
    };
    ElementGroups groups(roll.garment, ElementGroups::Which::near);
    groups.find(roll.x, roll.motion, 6e-3, 1);
    int count = 0;
    for (int k = 0; k < groups.found(); ++k)
        groups.visit(k, [&](const ElementPair& pair, int f, int g) {
            ++count;
            for (const size_t i : {size_t(0), size_t(pair.edges)})
                for (size_t j = 1 + i; j < 4; ++j) EXPECT_NE(pair.vertex[i], pair.vertex[j]);
            if (pair.edges) {
                EXPECT_TRUE(has(elements.edges_of(f), pair.element[0]));
                EXPECT_TRUE(has(elements.edges_of(g), pair.element[1]));
            } else {
                EXPECT_TRUE(has(elements.vertices_of(f), pair.element[0]));
                EXPECT_EQ(g, pair.element[1]);
            }
        });
    EXPECT_GT(count, 1000);
}

}  // namespace cloth::element_groups_test
