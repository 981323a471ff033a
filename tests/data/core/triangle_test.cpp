#include "data/core/triangle.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::triangle_test {
namespace {

using namespace test;

/// A minimum of a convex function: no point of a fine grid over the triangle is closer.
TEST(Triangle, NoPointOfTheTriangleIsCloser) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3 a = random_point(random, 1), b = random_point(random, 1);
        const Vec3 c = random_point(random, 1), q = random_point(random, 2);
        const TriangleHit hit = closest_on_triangle(q, a, b, c);
        const Vec3 w = hit.barycentric;
        EXPECT_GE(w.minCoeff(), 0.0);
        EXPECT_NEAR(w.sum(), 1.0, 1e-14);
        EXPECT_NEAR((w[0] * a + w[1] * b + w[2] * c - q).squaredNorm(), hit.squared, 1e-12);
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20 - i; ++j) {
                const Vec3 other = (i * a + j * b + (20 - i - j) * c) / 20.0;
                EXPECT_GE((other - q).squaredNorm(), hit.squared - 1e-12);
            }
    }
}

TEST(Triangle, WeightsOfOtherCornersAreExactlyZero) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    const auto zeros = [&](const Vec3& q) {
        return (closest_on_triangle(q, a, b, c).barycentric.array() == 0.0).count();
    };
    EXPECT_EQ(zeros({0.2, 0.3, 5}), 0);
    EXPECT_EQ(zeros({0.3, -1, 2}), 1);
    EXPECT_EQ(zeros({-1, 0.3, 2}), 1);
    EXPECT_EQ(zeros({2, 2, 2}), 1);
    EXPECT_EQ(zeros({-1, -1, 2}), 2);
    EXPECT_EQ(zeros({3, -1, 2}), 2);
    EXPECT_EQ(zeros({-1, 3, 2}), 2);
}

TEST(Triangle, NormalPointsToTheCounterClockwiseSide) {
    Vec3 normal;
    ASSERT_TRUE(triangle_normal({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, normal));
    EXPECT_EQ(normal, Vec3(0, 0, 1));
}

TEST(Triangle, WithoutAreaOrFiniteCornersHasNoNormal) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    Vec3 normal;
    EXPECT_FALSE(triangle_normal({0, 0, 0}, {1, 0, 0}, {0.3, 0, 0}, normal));
    EXPECT_EQ(normal, Vec3(0, 0, 0));
    EXPECT_FALSE(has_area({1, 2, 3}, {1, 2, 3}, {1, 2, 3}));
    EXPECT_FALSE(has_area({nan, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_FALSE(has_area({inf, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_TRUE(has_area({0, 0, 0}, {1e-6, 0, 0}, {0, 1e-6, 0}));
}

TEST(Triangle, ALineMeetsItsPlaneWhereTheyAreEqual) {
    std::mt19937 random(2);
    int inside = 0;
    for (int trial = 0; trial < 500; ++trial) {
        const Vec3 a = random_point(random, 1), b = random_point(random, 1);
        const Vec3 c = random_point(random, 1), from = random_point(random, 1);
        const Vec3 way = random_point(random, 1);
        const auto hit = meet_line(from, way, a, b, c);
        ASSERT_TRUE(hit);
        const Vec3 in_plane = a + hit->u * (b - a) + hit->v * (c - a);
        const double size = 1.0 + std::abs(hit->at) + std::abs(hit->u) + std::abs(hit->v);
        EXPECT_LT((from + hit->at * way - in_plane).norm(), 1e-9 * size);
        const double apart = closest_on_triangle(in_plane, a, b, c).squared;
        if (hit->is_inside()) {
            EXPECT_LT(apart, 1e-20);
        } else if (!hit->is_inside(1e-6)) {
            EXPECT_GT(apart, 0.0);
        }
        inside += hit->is_inside();
    }
    EXPECT_GT(inside, 20);
}

TEST(Triangle, AParallelLineDoesNotMeetIt) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    EXPECT_FALSE(meet_line({0.2, 0.2, 1}, {1, 1, 0}, a, b, c));
    EXPECT_FALSE(meet_line({0.2, 0.2, 1}, {0, 0, -1}, a, b, b)) << "no area";
    const auto edge = meet_line({0.5, -1e-12, 1}, {0, 0, -1}, a, b, c);
    ASSERT_TRUE(edge);
    EXPECT_FALSE(edge->is_inside());
    EXPECT_TRUE(edge->is_inside(1e-9));
}

}  // namespace
}  // namespace cloth::triangle_test
