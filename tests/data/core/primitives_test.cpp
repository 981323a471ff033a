#include "data/core/primitives.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::primitives_test {
namespace {

using namespace test;

std::vector<Obstacle> shapes() {
    return {primitive(ObstacleShape::sphere, Vec3::Zero(), 0.7),
            primitive(ObstacleShape::capsule, {0, 0.5, 0}, 0.3),
            primitive(ObstacleShape::box, {0.3, 0.5, 0.7}, 0.0),
            primitive(ObstacleShape::box, {0.3, 0.5, 0.7}, 0.1),
            primitive(ObstacleShape::plane, Vec3::Zero(), 0.0)};
}

/// Surface points by another way: far points pulled back along the distance's gradient.
Points surface_samples(const Obstacle& shape) {
    std::mt19937 random(3);
    Points samples = random_points(random, 4000, 2.0);
    for (Eigen::Index i = 0; i < samples.rows(); ++i)
        samples.row(i) = closest_on_primitive(shape, samples.row(i).transpose()).point;
    return samples;
}

TEST(Primitives, ClosestPointIsOnTheSurfaceAtTheDistance) {
    std::mt19937 random(1);
    for (const Obstacle& shape : shapes())
        for (int trial = 0; trial < 500; ++trial) {
            const Vec3 q = random_point(random, 1.5);
            const PrimitiveHit hit = closest_on_primitive(shape, q);
            EXPECT_NEAR(closest_on_primitive(shape, hit.point).distance, 0.0, 1e-12);
            EXPECT_NEAR((q - hit.point).norm(), std::abs(hit.distance), 1e-12);
            EXPECT_NEAR(hit.normal.norm(), 1.0, 1e-12);
            EXPECT_NEAR((q - hit.point).dot(hit.normal), hit.distance, 1e-12);
        }
}

TEST(Primitives, NoSurfacePointIsCloser) {
    std::mt19937 random(2);
    for (const Obstacle& shape : shapes()) {
        const Points samples = surface_samples(shape);
        for (int trial = 0; trial < 50; ++trial) {
            const Vec3 q = random_point(random, 1.5);
            const double closest = (samples.rowwise() - q.transpose()).rowwise().norm().minCoeff();
            EXPECT_LE(std::abs(closest_on_primitive(shape, q).distance), closest + 1e-12);
        }
    }
}

TEST(Primitives, DistanceAloneIsTheSameToTheBit) {
    std::mt19937 random(4);
    for (const Obstacle& shape : shapes())
        for (int trial = 0; trial < 2000; ++trial) {
            const Vec3 q = random_point(random, trial % 2 == 0 ? 1.5 : 0.3);
            const double distance = distance_to_primitive(shape, q);
            EXPECT_EQ(distance, closest_on_primitive(shape, q).distance);
            EXPECT_GE(distance, q.norm() - reach_of_primitive(shape) - 1e-12);
        }
}

TEST(Primitives, KnownDistances) {
    const auto all = shapes();
    const auto distance = [&](size_t shape, const Vec3& q) {
        return closest_on_primitive(all[shape], q).distance;
    };
    EXPECT_DOUBLE_EQ(distance(0, {0, 1, 0}), 0.3);
    EXPECT_DOUBLE_EQ(distance(0, {0.2, 0, 0}), -0.5);
    EXPECT_DOUBLE_EQ(distance(1, {0, 1, 0}), 0.2);
    EXPECT_DOUBLE_EQ(distance(1, {0, -0.4, 0.1}), -0.2);
    EXPECT_DOUBLE_EQ(distance(2, {0.6, 0.9, 0}), 0.5);
    EXPECT_NEAR(distance(2, {0.1, 0.45, 0}), -0.05, 1e-15);
    EXPECT_NEAR(distance(3, {0.6, 0.9, 0}), 0.4, 1e-15);
    EXPECT_NEAR(distance(3, {0.1, 0.45, 0}), -0.15, 1e-15);
    EXPECT_DOUBLE_EQ(distance(4, {3, -0.25, 1}), -0.25);
}

TEST(Primitives, AmbiguousPointsHaveAUnitNormal) {
    for (const Obstacle& shape : shapes()) {
        const PrimitiveHit hit = closest_on_primitive(shape, Vec3::Zero());
        EXPECT_NEAR(hit.normal.norm(), 1.0, 1e-15);
        EXPECT_LE(hit.distance, 0.0);
    }
}

TEST(Primitives, JustOutsideABoxTheNormalIsThatOfTheSide) {
    const Obstacle box = primitive(ObstacleShape::box, {0.3, 0.5, 0.7}, 0.0);
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (const double gap : {-1e-15, 0.0, 1e-15, 1e-9}) {
                Vec3 q(0.1, 0.1, 0.1), normal = Vec3::Zero();
                q[axis] = side * (box.half_extents[axis] + gap);
                normal[axis] = side;
                const PrimitiveHit hit = closest_on_primitive(box, q);
                EXPECT_TRUE(hit.normal.isApprox(normal, 1e-6)) << axis << ' ' << side << ' ' << gap;
                EXPECT_NEAR(hit.distance, gap, 1e-14);
            }
}

TEST(Primitives, BadSizesAreNotUsable) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Obstacle& shape : shapes()) EXPECT_TRUE(is_usable_primitive(shape));
    EXPECT_FALSE(is_usable_primitive(primitive(ObstacleShape::sphere, Vec3::Zero(), -1.0)));
    EXPECT_FALSE(is_usable_primitive(primitive(ObstacleShape::capsule, {0, nan, 0}, 1.0)));
    EXPECT_FALSE(is_usable_primitive(primitive(ObstacleShape::box, {1, -1, 1}, 0.0)));
    Obstacle plane = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    plane.pose1.translation().x() = nan;
    EXPECT_FALSE(is_usable_primitive(plane));
}

}  // namespace
}  // namespace cloth::primitives_test
