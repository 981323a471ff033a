#include "collision/response/neighbour_pull.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"

namespace cloth::neighbour_pull_test {
namespace {

/// A sheet of a metre in the plane y = 0.
Garment sheet(const std::vector<int>& pins = {}) {
    return Garment("sheet", make_sheet(1.0, 1.0, 400), Fabric::soft_cotton(), pins);
}

double length(const Points& x, const std::array<int, 2>& edge) {
    return (x.row(edge[0]) - x.row(edge[1])).norm();
}

/// Of the edges whose ends are not both in `held`: the longest over its length at rest.
double stretch(const Garment& garment, const Points& x, const std::set<int>& held = {}) {
    double most = 0.0;
    for (const auto& edge : garment.edges())
        if (!held.count(edge[0]) || !held.count(edge[1]))
            most = std::max(most, length(x, edge) / length(garment.rest().vertices, edge));
    return most;
}

int middle(const Points& x) {
    Eigen::Index nearest;
    x.rowwise().squaredNorm().minCoeff(&nearest);
    return static_cast<int>(nearest);
}

class MiddleOfASheet : public ::testing::Test {
 protected:
    /// The sheet at rest, but for its middle.
    Points lifted(double by) const {
        Points x = rest;
        x(vertex, 1) += by;
        return x;
    }
    const Garment garment = sheet();
    const Points& rest = garment.rest().vertices;
    const int vertex = middle(rest);
};

TEST_F(MiddleOfASheet, LeavesNoEdgeLongerThanTheLimit) {
    for (const double most : {1.05, 1.5}) {
        NeighbourPull pull(garment, most);
        Points x = lifted(0.2);
        const Points moved = x;
        const std::vector<int> followers = pull.follow({vertex}, rest, x);
        EXPECT_LT(stretch(garment, x), 1.001 * most + 1e-9);
        EXPECT_EQ(x.row(vertex), moved.row(vertex));
        EXPECT_TRUE(std::is_sorted(followers.begin(), followers.end()));
        const std::set<int> followed(followers.begin(), followers.end());
        EXPECT_EQ(followed.size(), followers.size());
        for (int i = 0; i < x.rows(); ++i)
            EXPECT_EQ(x.row(i) != rest.row(i), i == vertex || followed.count(i) > 0);
    }
}

TEST_F(MiddleOfASheet, TakesNothingAlongThatIsNotStretched) {
    NeighbourPull pull(garment, 1.5);
    Points x = lifted(0.01);
    EXPECT_TRUE(pull.follow({vertex}, rest, x).empty());
    EXPECT_EQ(x.bottomRows(x.rows() - vertex - 1), rest.bottomRows(x.rows() - vertex - 1));
}

TEST_F(MiddleOfASheet, TakesNoVertexFartherThanItselfAndNoFarOne) {
    NeighbourPull pull(garment, 1.5);
    Points x = lifted(0.15);
    pull.follow({vertex}, rest, x);
    for (int i = 0; i < x.rows(); ++i) {
        const double way = (x.row(i) - rest.row(i)).norm();
        EXPECT_LE(way, 0.15 + 1e-12);
        const bool far = (rest.row(i) - rest.row(vertex)).norm() > 0.35;
        EXPECT_TRUE(!far || way == 0.0) << "vertex " << i;
    }
}

TEST_F(MiddleOfASheet, TakesNeitherPinsNorVerticesThatWereMovedAlong) {
    std::set<int> around;
    for (const auto& [a, b] : garment.edges()) {
        if (a == vertex) around.insert(b);
        if (b == vertex) around.insert(a);
    }
    const int pin = *around.begin(), moved = *around.rbegin();
    NeighbourPull pull(sheet({pin}), 1.2);
    Points x = lifted(0.2);
    const std::vector<int> both = {std::min(vertex, moved), std::max(vertex, moved)};
    const std::vector<int> followers = pull.follow(both, rest, x);
    EXPECT_EQ(x.row(pin), rest.row(pin));
    EXPECT_EQ(x.row(moved), rest.row(moved));
    EXPECT_FALSE(followers.empty());
    // the next call knows nothing of this one
    Points again = lifted(0.2);
    pull.follow({vertex}, rest, again);
    EXPECT_NE(again.row(moved), rest.row(moved));
}

TEST(NeighbourPull, LongEdgesMayStayAsLongAsTheyWere) {
    const Garment garment = sheet();
    const Points before = 1.8 * garment.rest().vertices;
    const int vertex = middle(before);
    NeighbourPull pull(garment, 1.5);
    Points x = before;
    EXPECT_TRUE(pull.follow({vertex}, before, x).empty());
    x(vertex, 1) += 0.1;
    EXPECT_FALSE(pull.follow({vertex}, before, x).empty());
    for (const auto& edge : garment.edges())
        EXPECT_LE(length(x, edge), 1.001 * length(before, edge) + 1e-9);
}

TEST(NeighbourPull, AnyMotionsOfSeveralVerticesAreFollowed) {
    const Garment garment = sheet();
    const Points& rest = garment.rest().vertices;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> way(-0.1, 0.1);
    for (int round = 0; round < 20; ++round) {
        Points x = rest;
        std::set<int> moved;
        const Vec3 shift(way(random), way(random), way(random));
        for (int k = 0; k < 4; ++k)
            moved.insert(static_cast<int>(random() % static_cast<unsigned>(x.rows())));
        for (const int i : moved) x.row(i) += shift.transpose();
        NeighbourPull pull(garment, 1.5);
        pull.follow({moved.begin(), moved.end()}, rest, x);
        EXPECT_LT(stretch(garment, x, moved), 1.001 * 1.5 + 1e-9) << "round " << round;
    }
}

TEST(NeighbourPull, LimitsOutOfRangeAreRefused) {
    EXPECT_THROW(NeighbourPull(sheet(), 0.9), ArgumentError);
    EXPECT_THROW(NeighbourPull(sheet(), 2.1), ArgumentError);
}

}  // namespace
}  // namespace cloth::neighbour_pull_test
