#include "collision/self/self_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "collision/geometry/segment.h"
#include "tests/collision/self/self_scenes.h"

namespace cloth::self_proximity_test {
namespace {

using namespace test;

/// The definition of SelfProximity::find, without its shortcuts; gives the pairs' distances at x.
std::map<Key, double> brute_force(const Garment& garment, const Points& x, const Points& motion,
                                  double reach, double thickness) {
    const std::vector<int> piece = garment_pieces(garment);
    const OffsetRegions regions(garment);
    std::map<Key, double> found;
    visit_all(garment, [&](const ElementPair& pair) {
        const ClosestPoints points = closest_points(pair.edges, corners_of(pair, x));
        Vec3 shift = Vec3::Zero();
        for (size_t k = 0; k < 4; ++k)
            shift += points.weight[k] * motion.row(pair.vertex[k]).transpose();
        const SegmentHit way =
            closest_on_segments(points.offset, points.offset + shift, Vec3::Zero(), Vec3::Zero());
        const double rest =
            closest_points(pair.edges, corners_of(pair, garment.rest().vertices)).squared;
        const bool same = piece[size_t(pair.vertex[0])] == piece[size_t(pair.vertex[3])];
        if (points.facing && points.squared > 0.0 && way.squared <= reach * reach &&
            regions.contain(pair, points, x) && !(same && rest < thickness * thickness))
            found[key_of(pair)] = std::sqrt(points.squared);
    });
    return found;
}

void expect_same_pairs(const SelfProximity& proximity, const std::map<Key, double>& expected) {
    std::set<Key> keys;
    for (const SelfPair& pair : proximity.pairs()) {
        const auto at = expected.find(key_of(pair.elements));
        ASSERT_NE(at, expected.end());
        EXPECT_NEAR(pair.distance, at->second, 1e-12);
        EXPECT_TRUE(keys.insert(key_of(pair.elements)).second) << "a pair comes twice";
    }
    EXPECT_EQ(keys.size(), expected.size());
}

Points smooth_motion(const Points& x, double size) {
    Points motion(x.rows(), 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        motion.row(i) << size * std::sin(20 * x(i, 1)), -size * std::cos(15 * x(i, 0)),
            0.3 * size * std::sin(30 * x(i, 2) + x(i, 0));
    return motion;
}

}  // namespace

TEST(ClosestOnSegments, NoSampleOfTheSegmentsIsCloser) {
    std::mt19937 random(3);
    for (int repeat = 0; repeat < 500; ++repeat) {
        std::array<Vec3, 4> x;
        for (Vec3& point : x) point = random_point(random, 1.0);
        if (repeat % 5 == 0) x[3] = x[2] + 0.7 * (x[1] - x[0]);  // parallel
        if (repeat % 7 == 0) x[1] = x[0];                        // a point
        const SegmentHit hit = closest_on_segments(x[0], x[1], x[2], x[3]);
        const Vec3 p = x[0] + hit.s * (x[1] - x[0]), q = x[2] + hit.t * (x[3] - x[2]);
        EXPECT_NEAR((p - q).squaredNorm(), hit.squared, 1e-12);
        double least = 1e9;
        for (int a = 0; a <= 40; ++a)
            for (int b = 0; b <= 40; ++b)
                least = std::min(least,
                                 (x[0] + a / 40.0 * (x[1] - x[0]) - x[2] - b / 40.0 * (x[3] - x[2]))
                                     .squaredNorm());
        EXPECT_LE(hit.squared, least + 1e-12);
        EXPECT_GT(std::sqrt(hit.squared), std::sqrt(least) - 0.1) << "not on the segments";
    }
}

TEST(ClosestPointsOfElements, WeightsGiveTheOffset) {
    std::mt19937 random(4);
    for (const bool edges : {false, true})
        for (int repeat = 0; repeat < 100; ++repeat) {
            std::array<Vec3, 4> x;
            for (Vec3& point : x) point = random_point(random, 1.0);
            const ClosestPoints points = closest_points(edges, x);
            Vec3 sum = Vec3::Zero();
            double total = 0.0;
            for (size_t k = 0; k < 4; ++k)
                sum += points.weight[k] * x[k], total += points.weight[k];
            EXPECT_LT((sum - points.offset).norm(), 1e-12);
            EXPECT_NEAR(points.offset.squaredNorm(), points.squared, 1e-12);
            EXPECT_NEAR(total, 0.0, 1e-12);
        }
}

TEST(ClosestPointsOfElements, OnlyElementsOnTopOfEachOtherFace) {
    const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 0, 1);
    EXPECT_TRUE(closest_points(false, {Vec3(0.2, 0.1, 0.2), a, b, c}).facing);
    EXPECT_TRUE(closest_points(false, {Vec3(-0.05, -0.1, 0.2), a, b, c}).facing);
    EXPECT_FALSE(closest_points(false, {Vec3(-0.2, 0.1, 0.2), a, b, c}).facing);
    EXPECT_FALSE(closest_points(false, {Vec3(-0.2, 0.0, 0.2), a, b, c}).facing);
    EXPECT_TRUE(closest_points(true, {Vec3(0.5, 0.1, -1), Vec3(0.5, 0.1, 1), a, b}).facing);
    EXPECT_FALSE(closest_points(true, {Vec3(0.5, 0.1, 0.1), Vec3(0.5, 0.1, 1), a, b}).facing);
}

TEST(SelfProximity, FindsWhatBruteForceFindsInARoll) {
    const Garment garment = strip();
    SelfProximity proximity(garment, 4e-3);
    const Points x = wound(garment.rest().vertices, 8e-3);
    proximity.find(x, Points::Zero(x.rows(), 3), 0.012, 1);
    const auto expected = brute_force(garment, x, Points::Zero(x.rows(), 3), 0.012, 4e-3);
    ASSERT_GT(expected.size(), 300u);
    expect_same_pairs(proximity, expected);
}

TEST(SelfProximity, FindsWhatComesNearOnTheWay) {
    const Garment garment = strip();
    SelfProximity proximity(garment, 4e-3);
    const Points x = wound(garment.rest().vertices, 0.015);
    Points motion = smooth_motion(x, 0.02) - 0.6 * x;        // it shrinks
    motion.rowwise() += Eigen::RowVector3d(0.5, -1.0, 0.2);  // all of it flies
    proximity.find(x, motion, 5e-3, 2);
    const auto expected = brute_force(garment, x, motion, 5e-3, 4e-3);
    ASSERT_GT(expected.size(), 100u);
    expect_same_pairs(proximity, expected);
}

TEST(SelfProximity, FlatClothHasNoPairsAndLayersThatTouchAtRestCount) {
    const Garment flat = strip();
    SelfProximity proximity(flat, 4e-3);
    proximity.find(flat.rest().vertices, Points::Zero(flat.vertex_count(), 3), 0.02, 1);
    EXPECT_TRUE(proximity.pairs().empty());

    const Garment layers =
        two_sheets(2e-3).garment;  // nearer at rest than the thickness, but two pieces
    SelfProximity between(layers, 4e-3);
    between.find(layers.rest().vertices, Points::Zero(layers.vertex_count(), 3), 4e-3, 1);
    EXPECT_GT(between.pairs().size(), 300u);
    for (const SelfPair& pair : between.pairs()) {  // a vertex beside the other sheet looks aslant
        EXPECT_NEAR(pair.distance * std::abs(pair.normal.y()), 2e-3, 1e-9);
        EXPECT_NEAR(pair.distance_at(layers.rest().vertices), pair.distance, 1e-9);
        EXPECT_GT(std::abs(pair.normal.y()), 0.7);
    }
}

TEST(SelfProximity, ElementsOfOnePieceThatAreNearAtRestAreLeftOut) {
    const Garment garment = strip(1500);  // edges of 9 mm
    SelfProximity thin(garment, 1e-3), thick(garment, 0.02);
    Points x = garment.rest().vertices;  // folded in the middle, 4 mm high
    x.col(1) = 4e-3 * (x.col(0).array() > 0.0).cast<double>();
    x.col(0) = x.col(0).cwiseAbs();
    const Points still = Points::Zero(x.rows(), 3);
    thin.find(x, still, 8e-3, 1);
    thick.find(x, still, 8e-3, 1);
    EXPECT_LT(thick.pairs().size(), thin.pairs().size());
    for (const SelfPair& pair : thick.pairs())
        EXPECT_GE(
            closest_points(pair.elements.edges, corners_of(pair.elements, garment.rest().vertices))
                .squared,
            0.02 * 0.02);
}

TEST(SelfProximity, SameBitsForAnyNumberOfThreads) {
    const Garment garment = strip(1000);
    const Points x = wound(garment.rest().vertices, 6e-3);
    const Points motion = smooth_motion(x, 0.01);
    SelfProximity one(garment, 4e-3), four(garment, 4e-3);
    one.find(x, motion, 6e-3, 1);
    four.find(x, motion, 6e-3, 4);
    ASSERT_EQ(one.pairs().size(), four.pairs().size());
    ASSERT_GT(one.pairs().size(), 1000u);
    for (size_t k = 0; k < one.pairs().size(); ++k) {
        EXPECT_EQ(one.pairs()[k].elements.vertex, four.pairs()[k].elements.vertex);
        EXPECT_EQ(one.pairs()[k].weight, four.pairs()[k].weight);
        EXPECT_EQ(one.pairs()[k].normal, four.pairs()[k].normal);
    }
}

TEST(SelfProximity, NumbersThatAreNotFiniteMakeNoPair) {
    const Garment garment = strip();
    SelfProximity proximity(garment, 4e-3);
    Points x = wound(garment.rest().vertices, 8e-3);
    x.row(7).setConstant(std::nan(""));
    proximity.find(x, Points::Zero(x.rows(), 3), 0.012, 1);
    for (const SelfPair& pair : proximity.pairs()) EXPECT_TRUE(pair.normal.allFinite());
}

}  // namespace cloth::self_proximity_test
