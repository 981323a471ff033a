#include "gnn/physics/stepper/passing_vertices.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/gnn/physics/stepper/tangled_scenes.h"

namespace cloth::passing_vertices_test {
namespace {

using namespace test;

long count(const std::vector<char>& marked) {
    return std::count(marked.begin(), marked.end(), 1);
}

/// A sheet of which a corner went through it; the overlap is half of the sheet.
class PassingVerticesTest : public ::testing::Test {
 protected:
    LayerScene scene = corner_through_itself();
    const Points& x = scene.start.x;
    const std::vector<Tangle> tangles = SelfTangles(scene.garment).find(x);
    std::vector<char> overlapped = std::vector<char>(size_t(x.rows()), 0);
    PassingVertices vertices{scene.garment};

    void SetUp() override {
        ASSERT_GT(tangles.size(), 3u);
        const Points& rest = scene.garment.rest().vertices;
        for (Eigen::Index i = 0; i < x.rows(); ++i) overlapped[size_t(i)] = rest(i, 0) > 0.0;
    }
    /// Positions of the step number `step`.
    Points at(int step) const { return x.array() + 0.01 * step; }
};

}  // namespace

TEST_F(PassingVerticesTest, PassAsLongAsTheyAreTangled) {
    vertices.begin_step(at(0), {}, &tangles);
    EXPECT_EQ(count(vertices.passing()), 0) << "was not overlapped";
    vertices.begin_step(at(1), overlapped, &tangles);
    EXPECT_EQ(vertices.passing(), overlapped);
    for (int step = 2; step < 5; ++step) {
        vertices.begin_step(at(step), {}, &tangles);
        EXPECT_EQ(vertices.passing(), overlapped) << "one piece, which is tangled";
    }
    vertices.begin_step(at(5), {}, nullptr);
    EXPECT_EQ(count(vertices.passing()), 0);
    vertices.begin_step(at(6), {}, &tangles);
    EXPECT_EQ(count(vertices.passing()), 0);
}

TEST_F(PassingVerticesTest, WhatNoTangleReachesPassesNoMore) {
    std::vector<char> far(overlapped.size(), 1);  // but for what is tangled, and its neighbours
    const auto clear = [&](int i) { far[size_t(i)] = 0; };
    for (const Tangle& tangle : tangles) {
        for (const int i : scene.garment.edges()[size_t(tangle.edge)]) clear(i);
        for (int k = 0; k < 3; ++k) clear(scene.garment.rest().faces(tangle.face, k));
    }
    ASSERT_GT(count(far), 100);
    vertices.begin_step(at(0), far, &tangles);
    EXPECT_EQ(vertices.passing(), far);
    vertices.begin_step(at(1), {}, &tangles);
    EXPECT_EQ(count(vertices.passing()), 0);
}

TEST_F(PassingVerticesTest, AStepTakenAgainIsTheSame) {
    vertices.begin_step(at(0), overlapped, &tangles);
    for (int again = 0; again < 3; ++again) {
        vertices.begin_step(at(1), {}, &tangles);
        EXPECT_EQ(vertices.passing(), overlapped);
    }
    vertices.begin_step(at(2), {}, nullptr);
    for (int again = 0; again < 3; ++again) {
        vertices.begin_step(at(3), {}, &tangles);
        EXPECT_EQ(count(vertices.passing()), 0);
    }
}

TEST_F(PassingVerticesTest, NothingRepelsWhatIsOverlappedOrTangled) {
    vertices.begin_step(at(0), overlapped, &tangles);
    vertices.begin_step(at(1), {}, &tangles);
    EXPECT_LT(count(vertices.unrepelled()), count(overlapped)) << "what only passes is repelled";
    for (const Tangle& tangle : tangles)
        for (const int i : scene.garment.edges()[size_t(tangle.edge)])
            EXPECT_EQ(vertices.unrepelled()[size_t(i)], 1);
    vertices.begin_step(at(2), overlapped, nullptr);
    EXPECT_EQ(vertices.unrepelled(), overlapped);
    vertices.begin_step(at(3), {}, nullptr);
    EXPECT_TRUE(vertices.unrepelled().empty());
}

}  // namespace cloth::passing_vertices_test
