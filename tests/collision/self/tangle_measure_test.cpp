#include "collision/self/tangle_measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/collision/self/self_scenes.h"

namespace cloth::tangle_measure_test {
namespace {

using namespace test;

/// A roll of which every vertex is thrown off its place: hundreds of tangles.
Points shaken_roll(const Garment& garment, unsigned seed, double size = 5e-3) {
    std::mt19937 random(seed);
    const Points x = wound(garment.rest().vertices, 4e-3);
    return x + random_points(random, x.rows(), size);
}

std::array<Vec3, 3> corners(const Garment& garment, const Points& x, int f) {
    const auto face = garment.rest().faces.row(f);
    return {x.row(face[0]), x.row(face[1]), x.row(face[2])};
}

/// The part of a line o + t d inside a triangle in whose plane it lies, as an interval of t.
std::optional<std::array<double, 2>> inside(const std::array<Vec3, 3>& c, const Vec3& o,
                                            const Vec3& d) {
    const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]);
    double low = -1e9, high = 1e9;
    for (size_t k = 0; k < 3; ++k) {
        const Vec3 inward = normal.cross(c[(k + 1) % 3] - c[k]);
        const double at = inward.dot(o - c[k]), slope = inward.dot(d);
        if (slope == 0.0 && at < 0.0) return {};
        if (slope > 0.0) low = std::max(low, -at / slope);
        if (slope < 0.0) high = std::min(high, -at / slope);
    }
    if (!(low < high)) return {};
    return std::array<double, 2>{low, high};
}

/// Length of the line in which two triangles meet: the common part of what each of them covers of
/// the line in which their planes meet.
double common_length(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    const Vec3 n = (a[1] - a[0]).cross(a[2] - a[0]).normalized();
    const Vec3 m = (b[1] - b[0]).cross(b[2] - b[0]).normalized();
    const Vec3 d = n.cross(m).normalized();
    Eigen::Matrix3d planes;
    planes << n.transpose(), m.transpose(), d.transpose();
    const Vec3 o = planes.inverse() * Vec3(n.dot(a[0]), m.dot(b[0]), d.dot(a[0]));
    const auto first = inside(a, o, d), second = inside(b, o, d);
    if (!first || !second) return 0.0;
    return std::max(0.0, std::min((*first)[1], (*second)[1]) - std::max((*first)[0], (*second)[0]));
}

double brute_force_length(const Garment& garment, const Points& x) {
    double length = 0.0;
    const Faces& faces = garment.rest().faces;
    for (int f = 0; f < faces.rows(); ++f)
        for (int g = f + 1; g < faces.rows(); ++g) {
            int common = 0;
            for (int k = 0; k < 3; ++k)
                for (int l = 0; l < 3; ++l) common += faces(f, k) == faces(g, l);
            if (common < 2)  // faces at an edge meet in it
                length += common_length(corners(garment, x, f), corners(garment, x, g));
        }
    return length;
}

/// A sheet that stands upright in another one, of which `below` (m) are beneath it.
MergedGarments crossed_sheets(double below) {
    TriMesh upright = make_sheet(0.2, 0.2, 150, 2);
    const double bottom = upright.vertices.col(2).minCoeff();
    for (Eigen::Index i = 0; i < upright.vertices.rows(); ++i)
        upright.vertices.row(i) << upright.vertices(i, 0) + 0.0013,
            upright.vertices(i, 2) - bottom - below, 0.0021;
    return merge_garments("crossed sheets",
                          {Garment("level", make_sheet(0.3, 0.3, 150), Fabric::soft_cotton()),
                           Garment("upright", upright, Fabric::soft_cotton())});
}

}  // namespace

TEST(TangleMeasure, LengthIsThatOfBruteForceOverAllPairsOfFaces) {
    const Garment garment = strip();
    TangleMeasure measure(garment);
    for (const unsigned seed : {1u, 2u, 3u}) {
        const Points x = shaken_roll(garment, seed);
        EXPECT_GT(measure.find(x, 1), 0.5);
        EXPECT_NEAR(measure.length(), brute_force_length(garment, x), 1e-9);
    }
}

TEST(TangleMeasure, GradientIsThatOfFiniteDifferences) {
    const Garment garment = strip(150);
    TangleMeasure measure(garment);
    constexpr double h = 1e-8;  // m
    int compared = 0;
    for (const unsigned seed : {4u, 5u}) {
        const Points x = shaken_roll(garment, seed);
        measure.find(x, 1);
        const size_t tangles = measure.tangles().size();
        ASSERT_GT(tangles, 50u);
        ASSERT_GT(measure.area(), 1e-4);
        Points gradient;
        measure.gradient(x, gradient);
        EXPECT_LT(gradient.colwise().sum().norm(), 1e-9 * gradient.norm());
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            for (int k = 0; k < 3; ++k) {
                Points there = x, here = x;
                there(i, k) += h;
                here(i, k) -= h;
                const double after = measure.find(there, 1);
                const size_t tangles_there = measure.tangles().size();
                const double before = measure.find(here, 1);
                if (tangles_there != tangles || measure.tangles().size() != tangles) continue;
                const double difference = (after - before) / (2 * h);
                EXPECT_NEAR(gradient(i, k), difference, 1e-4 * (1.0 + std::abs(difference)))
                    << "vertex " << i << ", coordinate " << k;
                ++compared;
            }
    }
    EXPECT_GT(compared, 500);
}

TEST(TangleMeasure, AreaIsThatOfTheSmallerSide) {
    for (const double below : {0.03, 0.07, 0.13}) {
        const MergedGarments sheets = crossed_sheets(below);
        TangleMeasure measure(sheets.garment);
        measure.find(sheets.garment.rest().vertices, 1);
        EXPECT_NEAR(measure.length(), 0.2, 1e-9) << below;
        EXPECT_NEAR(measure.area(), 0.2 * std::min(below, 0.2 - below), 1e-9) << below;
    }
}

TEST(TangleMeasure, TanglesOfOverlappedVerticesDoNotCount) {
    const MergedGarments sheets = crossed_sheets(0.07);
    const Points& x = sheets.garment.rest().vertices;
    TangleMeasure measure(sheets.garment);
    measure.find(x, 1);
    const std::vector<Tangle> all = measure.tangles();
    std::vector<char> overlapped(size_t(x.rows()), 0);
    const SelfTangles tangles(sheets.garment);
    for (Eigen::Index i = 0; i < x.rows(); ++i) overlapped[size_t(i)] = x(i, 0) > 0.02 ? 1 : 0;
    measure.find(x, 1, nullptr, overlapped);
    const auto at_overlapped = [&](const Tangle& tangle) {
        return tangles.is_at(tangle, overlapped);
    };
    const auto left_out = std::count_if(all.begin(), all.end(), at_overlapped);
    EXPECT_GT(left_out, 5);
    EXPECT_GT(measure.tangles().size(), 5u);
    EXPECT_EQ(measure.tangles().size(), all.size() - size_t(left_out));
    EXPECT_LT(measure.length(), 0.15);
    overlapped.assign(overlapped.size(), 1);
    EXPECT_EQ(measure.find(x, 1, nullptr, overlapped), 0.0);
}

TEST(TangleMeasure, IsContinuousWhereACornerComesOutOfAFace) {
    // drawn up little by little; with it, tangles come and go
    const MergedGarments sheets = crossed_sheets(0.09);
    TangleMeasure measure(sheets.garment);
    Points x = sheets.garment.rest().vertices;
    for (Eigen::Index i = sheets.first_vertex[1]; i < x.rows(); ++i) {  // askew, and bent
        x(i, 2) += 0.1 * x(i, 0) + 0.05 * x(i, 1);
        x(i, 1) += 0.3 * x(i, 0) + x(i, 0) * x(i, 0);
    }
    double last = measure.find(x, 1);
    size_t changes = 0, tangles = measure.tangles().size();
    while (tangles > 0) {
        x.bottomRows(x.rows() - sheets.first_vertex[1]).col(1).array() += 1e-4;
        const double size = measure.find(x, 1);
        ASSERT_NEAR(size, last, 0.01);
        last = size;
        changes += measure.tangles().size() != tangles;
        tangles = measure.tangles().size();
    }
    EXPECT_EQ(last, 0.0);
    EXPECT_GT(changes, 10u);
}

TEST(TangleMeasure, ABoundOnSteepnessLeavesForcesInBalance) {
    const Garment garment = strip(150);
    TangleMeasure measure(garment);
    const Points x = shaken_roll(garment, 9);
    measure.find(x, 1);
    Points gradient, exact;
    measure.gradient(x, exact);
    measure.gradient(x, gradient, 4.0);
    EXPECT_LT(gradient.norm(), exact.norm());
    EXPECT_LT(gradient.colwise().sum().norm(), 1e-9 * gradient.norm());
    Vec3 torque = Vec3::Zero();
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        torque += Vec3(x.row(i)).cross(Vec3(gradient.row(i)));
    EXPECT_LT(torque.norm(), 1e-9 * gradient.norm());
}

TEST(TangleMeasure, IsNothingWithoutTanglesAndTheSameForAnyNumberOfThreads) {
    const Garment garment = strip(1000);
    TangleMeasure one(garment), three(garment);
    EXPECT_EQ(one.find(wound(garment.rest().vertices, 8e-3), 1), 0.0);
    const Points x = shaken_roll(garment, 6);
    EXPECT_GT(one.find(x, 1), 0.0);
    EXPECT_EQ(one.find(x, 1), three.find(x, 3));
    Points a, b;
    one.gradient(x, a);
    three.gradient(x, b);
    EXPECT_TRUE(a == b);
}

}  // namespace cloth::tangle_measure_test
