#include "collision/self/self_tangles.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/collision/self/self_scenes.h"

namespace cloth::self_tangles_test {
namespace {

using namespace test;

std::set<std::array<int, 2>> brute_force(const Garment& garment, const Points& x) {
    std::set<std::array<int, 2>> found;
    const Faces& faces = garment.rest().faces;
    for (size_t e = 0; e < garment.edges().size(); ++e)
        for (int f = 0; f < faces.rows(); ++f) {
            const auto& [p, q] = garment.edges()[e];
            if ((faces.row(f).array() == p || faces.row(f).array() == q).any()) continue;
            // Where the edge's line meets the plane, in coordinates of the triangle.
            const Vec3 a = x.row(faces(f, 0)), b = x.row(faces(f, 1)), c = x.row(faces(f, 2));
            Eigen::Matrix3d system;
            system << b - a, c - a, (x.row(p) - x.row(q)).transpose();
            const Vec3 s = system.fullPivLu().solve(x.row(p).transpose() - a);
            if (s[0] > 0 && s[1] > 0 && s[0] + s[1] < 1 && s[2] > 0 && s[2] < 1)
                found.insert({int(e), f});
        }
    return found;
}

}  // namespace

TEST(EdgeCrossesFace, FindsThePointOrSaysNo) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 0, 1);
    Vec3 point;
    ASSERT_TRUE(edge_crosses_face({0.2, -1, 0.2}, {0.3, 1, 0.2}, a, b, c, point));
    EXPECT_LT((point - Vec3(0.25, 0, 0.2)).norm(), 1e-12);
    ASSERT_TRUE(edge_crosses_face({0.3, 1, 0.2}, {0.2, -1, 0.2}, a, c, b, point));
    EXPECT_LT((point - Vec3(0.25, 0, 0.2)).norm(), 1e-12);
    EXPECT_FALSE(edge_crosses_face({0.2, 0.1, 0.2}, {0.2, 1, 0.2}, a, b, c, point)) << "above";
    EXPECT_FALSE(edge_crosses_face({0.8, -1, 0.8}, {0.8, 1, 0.8}, a, b, c, point)) << "beside";
    EXPECT_FALSE(edge_crosses_face({-1, 0, 0.2}, {1, 0, 0.2}, a, b, c, point)) << "in the plane";
}

TEST(SelfTangles, FindsWhatBruteForceFinds) {
    const Garment garment = strip();
    SelfTangles tangles(garment);
    Points x = wound(garment.rest().vertices, 4e-3);
    std::mt19937 random(5);
    x += random_points(random, x.rows(), 5e-3);
    tangles.find(x, 2);
    const auto expected = brute_force(garment, x);
    ASSERT_GT(expected.size(), 50u);
    std::set<std::array<int, 2>> found;
    for (const Tangle& tangle : tangles.found()) found.insert({tangle.edge, tangle.face});
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), tangles.found().size()) << "one of them comes twice";
}

TEST(SelfTangles, ARollHasNoneAndItsPointsLieWhereLayersCross) {
    const Garment roll = strip();
    EXPECT_TRUE(SelfTangles(roll).find(wound(roll.rest().vertices, 8e-3)).empty());
    EXPECT_TRUE(SelfTangles(roll).find(roll.rest().vertices).empty());

    const MergedGarments layers = two_sheets(0.0);
    Points x = layers.garment.rest().vertices;
    for (Eigen::Index i = layers.first_vertex[1]; i < x.rows(); ++i)
        x(i, 1) = 0.5 * (x(i, 0) - 0.031);
    SelfTangles tangles(layers.garment);
    ASSERT_GT(tangles.find(x).size(), 20u);
    for (const Tangle& tangle : tangles.found()) {
        EXPECT_NEAR(tangle.point.x(), 0.031, 1e-9);
        EXPECT_NEAR(tangle.point.y(), 0.0, 1e-9);
    }
}

TEST(SelfTangles, SameForAnyNumberOfThreadsAndNoneInNumbersThatAreNotFinite) {
    const Garment garment = strip(1000);
    Points x = wound(garment.rest().vertices, 4e-3);
    std::mt19937 random(6);
    x += random_points(random, x.rows(), 5e-3);
    SelfTangles one(garment), four(garment);
    one.find(x, 1);
    four.find(x, 4);
    ASSERT_EQ(one.found().size(), four.found().size());
    ASSERT_GT(one.found().size(), 100u);
    for (size_t k = 0; k < one.found().size(); ++k) {
        EXPECT_EQ(one.found()[k].edge, four.found()[k].edge);
        EXPECT_EQ(one.found()[k].face, four.found()[k].face);
    }
    x(3, 1) = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(one.find(x).empty());
}

}  // namespace cloth::self_tangles_test
