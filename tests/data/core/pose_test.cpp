#include "data/core/pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/test_meshes.h"

namespace cloth::pose_test {
namespace {

using namespace test;

double difference(const Pose& a, const Pose& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(Interpolate, TurnsAndMovesEvenlyAlsoBeyondTheEnds) {
    const Vec3 axis(1, 2, -0.5), way(0.3, -1, 2);
    const Pose a = pose_of(Vec3::Zero(), 0.2, axis), b = pose_of(way, 0.5, axis);
    for (const double s : {-0.5, 0.1, 0.5, 0.9, 1.5, 4.0})
        EXPECT_LT(difference(interpolate(a, b, s), pose_of(s * way, 0.2 + 0.3 * s, axis)), 1e-12)
            << s;
}

TEST(Interpolate, EndsAndPosesThatRestAreKeptToTheBit) {
    const Pose a = pose_of({0.1, 0.2, 0.3}, 0.7, {1, 1, 0}), b = pose_of({1, 2, 3}, -0.4);
    EXPECT_EQ(interpolate(a, b, 0.0).matrix(), a.matrix());
    EXPECT_EQ(interpolate(a, b, 1.0).matrix(), b.matrix());
    for (const double s : {0.1, 1.0 / 3.0, 2.5})
        EXPECT_EQ(interpolate(a, a, s).matrix(), a.matrix());
}

TEST(Interpolate, TakesTheShorterWay) {
    const Pose a = pose_of(Vec3::Zero(), 0.9 * M_PI), b = pose_of(Vec3::Zero(), -0.9 * M_PI);
    EXPECT_LT(difference(interpolate(a, b, 0.5), pose_of(Vec3::Zero(), M_PI)), 1e-12);
}

TEST(Interpolate, PosesOfSinglePrecisionStayRotationsFarBeyondTheEnd) {
    const auto rounded = [](const Pose& pose) {
        Pose single = pose;
        single.linear() = pose.linear().cast<float>().cast<double>();
        return single;
    };
    const Pose a = rounded(pose_of(Vec3::Zero(), 0.3, {1, 2, 3}));
    const Pose b = rounded(pose_of(Vec3::Zero(), 0.31, {1, 2, 3}));
    const Eigen::Matrix3d turn = interpolate(a, b, 8.0).linear();
    EXPECT_LT((turn * turn.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), 0.38, 1e-5);
}

TEST(RotationBetween, IsEigens) {
    std::mt19937 random(2);
    const Points from = random_points(random, 200, 3.0), to = random_points(random, 200, 0.1);
    for (Eigen::Index i = 0; i < from.rows(); ++i) {
        const Vec3 a = from.row(i), b = to.row(i);
        const Eigen::Quaterniond turn = rotation_between(a, b);
        const Eigen::Quaterniond reference = Eigen::Quaterniond::FromTwoVectors(a, b);
        EXPECT_LT((turn.coeffs() - reference.coeffs()).cwiseAbs().maxCoeff(), 1e-15);
        // rounding is magnified where the directions are nearly opposite
        EXPECT_LT((turn * a.normalized() - b.normalized()).norm(), 1e-9);
    }
}

TEST(RotationBetween, EqualAndOppositeDirections) {
    std::mt19937 random(3);
    const Points directions = random_points(random, 50, 1.0);
    for (Eigen::Index i = 0; i < directions.rows(); ++i) {
        const Vec3 a = directions.row(i);
        EXPECT_LT(rotation_between(a, 2.0 * a).vec().norm(), 1e-7);
        const Eigen::Quaterniond turn = rotation_between(a, -3.0 * a);
        EXPECT_NEAR(turn.norm(), 1.0, 1e-12);
        EXPECT_LT((turn * a + a).norm(), 1e-7 * a.norm());
    }
}

TEST(Transformed, MovesEachPoint) {
    std::mt19937 random(1);
    const Points x = random_points(random, 7, 1.0);
    const Pose pose = pose_of({1, 2, 3}, 0.5, {1, 0, 1});
    const Points moved = transformed(x, pose);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        EXPECT_LT((moved.row(i).transpose() - pose * Vec3(x.row(i))).norm(), 1e-14);
}

}  // namespace
}  // namespace cloth::pose_test
