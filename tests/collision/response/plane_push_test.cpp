#include "collision/response/plane_push.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::plane_push_test {
namespace {

using namespace test;

constexpr double third = 1.0 / 3.0;

struct SlowPlane {
    std::array<int, 3> vertex;
    std::array<double, 3> weight;
    Vec3 normal;
    double height, mobility = 0.0, multiplier = 0.0, change = 0.0;

    double missing(const Points& x) const {
        double at = 0.0;
        for (size_t k = 0; k < 3; ++k)
            if (weight[k] != 0.0) at += weight[k] * x.row(vertex[k]).dot(normal);
        return height - at;
    }
};

/// The sweeps of PlanePush, every plane in each of them.
void solve_slowly(std::vector<SlowPlane> planes, const VectorX& inverse_masses, int sweeps,
                  Points& x) {
    std::vector<int> shares(size_t(x.rows()), 0);
    for (const SlowPlane& plane : planes)
        for (size_t k = 0; k < 3; ++k) shares[size_t(plane.vertex[k])] += plane.weight[k] != 0.0;
    for (SlowPlane& plane : planes)
        for (size_t k = 0; k < 3; ++k)
            plane.mobility += plane.weight[k] * plane.weight[k] * inverse_masses[plane.vertex[k]] *
                              shares[size_t(plane.vertex[k])];
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (SlowPlane& plane : planes) {
            plane.change = std::max(1.5 * plane.missing(x) / plane.mobility, -plane.multiplier);
            plane.multiplier += plane.change;
        }
        for (const SlowPlane& plane : planes)
            for (size_t k = 0; k < 3; ++k)
                x.row(plane.vertex[k]) += plane.weight[k] * inverse_masses[plane.vertex[k]] *
                                          plane.change * plane.normal.transpose();
    }
}

TEST(PlanePush, LiftsTheCentreOfAFaceByItsVertices) {
    PlanePush push(VectorX::Ones(4));
    Points x = Points::Zero(4, 3);
    push.add({0, 1, 2}, {third, third, third}, Vec3::UnitY(), 0.01);
    push.solve(100, 3.0, x);
    for (const int i : {0, 1, 2}) EXPECT_NEAR(x(i, 1), 0.01, 1e-5);
    EXPECT_EQ(x.row(3).norm(), 0.0);
    EXPECT_EQ(push.moved(), (std::vector<int>{0, 1, 2}));
}

TEST(PlanePush, LightVerticesMoveMoreAndPinnedOnesNever) {
    VectorX inverse(3);
    inverse << 2.0, 1.0, 0.0;
    PlanePush push(inverse);
    Points x = Points::Zero(3, 3);
    push.add({0, 1, 2}, {third, third, third}, Vec3::UnitY(), 0.01);
    push.solve(100, 10.0, x);
    EXPECT_NEAR(x(0, 1), 0.02, 1e-5);
    EXPECT_NEAR(x(1, 1), 0.01, 1e-5);
    EXPECT_EQ(x(2, 1), 0.0);
}

TEST(PlanePush, PlanesThatAgreeDoNotAddUp) {
    PlanePush push(VectorX::Ones(3));
    Points x = Points::Zero(3, 3);
    for (int repeat = 0; repeat < 5; ++repeat)
        push.add({0, 1, 2}, {third, third, third}, Vec3::UnitY(), 0.01);
    push.solve(100, 3.0, x);
    for (const int i : {0, 1, 2}) EXPECT_NEAR(x(i, 1), 0.01, 1e-5);
}

TEST(PlanePush, AFaceAndAVertexPartWithoutMomentum) {
    VectorX inverse(4);
    inverse << 1.0, 2.0, 4.0, 1.0;
    PlanePush push(inverse);
    std::mt19937 random(2);
    const Points before = random_points(random, 4, 1e-3);
    Points x = before;
    const std::array<double, 4> weight{1.0, -0.5, -0.3, -0.2};
    push.add_pair({0, 1, 2, 3}, weight, Vec3::UnitY(), 0.01);
    push.solve(200, 10.0, x);
    double height = 0.0, momentum = 0.0;
    for (int k = 0; k < 4; ++k) {
        height += weight[size_t(k)] * x(k, 1);
        momentum += (x(k, 1) - before(k, 1)) / inverse[k];
    }
    EXPECT_NEAR(height, 0.01, 1e-5);
    EXPECT_NEAR(momentum, 0.0, 1e-15);
    EXPECT_EQ(push.moved(), (std::vector<int>{0, 1, 2, 3}));
}

// Of 300 planes most lift nothing at first, and many do after some sweeps.
TEST(PlanePush, PlanesThatAreIdleForNowComeBackInTime) {
    constexpr int vertices = 60, planes = 300, sweeps = 25;
    std::mt19937 random(5);
    std::uniform_int_distribution<int> any(0, vertices - 1);
    std::uniform_real_distribution<double> height(-0.05, 0.01);
    const VectorX inverse = VectorX::LinSpaced(vertices, 0.5, 2.0);
    PlanePush push(inverse);
    std::vector<SlowPlane> slow;
    const Points before = random_points(random, vertices, 1e-3),
                 normals = random_points(random, planes, 1.0);
    for (int p = 0; p < planes; ++p) {
        const Vec3 normal = Vec3(normals.row(p)).normalized();
        const std::array<int, 3> at{any(random), any(random), any(random)};
        const std::array<double, 3> weight = p % 2 == 0 ? std::array<double, 3>{third, third, third}
                                                        : std::array<double, 3>{1.0, -1.0, 0.0};
        slow.push_back({at, weight, normal, height(random)});
        push.add(at, weight, normal, slow.back().height);
    }
    Points x = before, expected = before;
    push.solve(sweeps, 1e6, x);
    solve_slowly(slow, inverse, sweeps, expected);
    EXPECT_GT((expected - before).rowwise().norm().maxCoeff(), 0.01);
    EXPECT_LT((x - expected).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(PlanePush, PointsAboveTheirPlanesStay) {
    PlanePush push(VectorX::Ones(3));
    std::mt19937 random(1);
    const Points before = random_points(random, 3, 1.0);
    Points x = before;
    push.add({0, 1, 2}, {third, third, third}, Vec3::UnitZ(), -2.0);
    push.solve(100, 3.0, x);
    EXPECT_EQ(x, before);
}

TEST(PlanePush, PlanesThatContradictEachOtherAreBounded) {
    PlanePush push(VectorX::Ones(2));
    Points x = Points::Zero(2, 3);
    push.add({0, 1, 1}, {0.5, 0.5, 0.0}, Vec3::UnitY(), 0.01);
    push.add({0, 1, 1}, {0.5, 0.5, 0.0}, -Vec3::UnitY(), 0.01);
    push.add({0, 0, 0}, {1.0, 0.0, 0.0}, -Vec3::UnitY(), 0.0);
    push.solve(1000, 3.0, x);
    EXPECT_TRUE(x.allFinite());
    EXPECT_LE(x.rowwise().norm().maxCoeff(), 0.03 + 1e-12);
}

}  // namespace
}  // namespace cloth::plane_push_test
