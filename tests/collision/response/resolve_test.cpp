#include "collision/response/resolve.h"

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "tests/test_meshes.h"

namespace cloth::resolve_test {
namespace {

using namespace test;

TEST(ProjectOut, VerticesBelowTheCarriedPlaneEndAtTheDistance) {
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    floor.pose1 = pose_of({0, 0.5, 0}, 0.3, {0, 0, 1});
    const Vec3 normal = floor.pose1.linear() * Vec3::UnitY();
    Proximity proximity({0.5, 0});
    SurfaceContacts contacts;
    std::mt19937 random(1);
    const Points x_t = random_points(random, 200, 0.3);
    proximity.query(x_t, boundary_of({floor}), contacts);
    const Points guess = random_points(random, 200, 1.0);
    Points x = guess;
    const int moved = project_out(contacts, 0.01, x);
    int below = 0;
    for (Eigen::Index i = 0; i < 200; ++i) {
        const auto height = [&](const Points& at) {
            return normal.dot(at.row(i).transpose() - Vec3(0, 0.5, 0));
        };
        if (height(guess) >= 0.01) {
            EXPECT_EQ(Vec3(x.row(i)), Vec3(guess.row(i)));
            continue;
        }
        ++below;
        EXPECT_NEAR(height(x), 0.01, 1e-12);
        const Vec3 push = x.row(i) - guess.row(i);
        EXPECT_NEAR(push.cross(normal).norm(), 0.0, 1e-12) << "only along the normal";
    }
    EXPECT_EQ(moved, below);
    EXPECT_GT(moved, 20);
}

TEST(ProjectOut, VerticesWithoutContactStay) {
    Proximity proximity;
    SurfaceContacts contacts;
    std::mt19937 random(2);
    const Points before = random_points(random, 10, 1.0);
    Points x = before;
    proximity.query(x, Boundary(), contacts);
    EXPECT_EQ(project_out(contacts, 0.01, x), 0);
    EXPECT_EQ(x, before);
}

TEST(ResolvePenetration, NothingIsLeftInsideARoughBall) {
    Obstacle ball = mesh_obstacle(roughened(icosphere(3), 0.03, 1));
    ball.x0.rowwise() += Eigen::RowVector3d(9, 9, 9);  // only the end of the step counts
    const Boundary boundary = boundary_of({ball});
    std::mt19937 random(3);
    const Points before = random_points(random, 600, 1.0);
    Points x = before;
    Proximity proximity({0.3, 0});
    VectorX distance;
    proximity.signed_distance(x, boundary, StepEnd::end, distance);
    const double depth = -distance.minCoeff();
    const ResolveReport report = resolve_penetration(proximity, boundary, 1e-3, x);
    EXPECT_DOUBLE_EQ(report.max_depth_before, depth);
    EXPECT_GT(depth, 0.2);
    EXPECT_EQ(report.max_depth_after, 0.0);
    EXPECT_GT(report.moved, 100);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (distance[i] > 1e-3) {
            EXPECT_EQ(Vec3(x.row(i)), Vec3(before.row(i)));
        } else {
            const double after =
                brute_force_signed_distance(boundary, StepEnd::end, x.row(i).transpose());
            EXPECT_GE(after, 1e-3 - 1e-8);
            EXPECT_LE((x.row(i) - before.row(i)).norm(), 1e-3 - distance[i] + 0.1);
        }
    }
}

/// Out of the floor is into the wall: one pass is not enough.
TEST(ResolvePenetration, ACornerTakesSeveralIterations) {
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0), wall = floor;
    floor.pose1 = pose_of(Vec3::Zero());
    wall.pose1 = pose_of(Vec3::Zero(), -M_PI / 4, {0, 0, 1});  // normal (1, 1, 0) / sqrt 2
    Points x(1, 3);
    x << 0.0, -0.1, 0.0;
    Proximity proximity({0.5, 0});
    const ResolveReport report =
        resolve_penetration(proximity, boundary_of({floor, wall}), 1e-3, x, 8);
    EXPECT_EQ(report.max_depth_after, 0.0);
    EXPECT_GE(report.iterations, 2);
    EXPECT_EQ(report.moved, 1);
    EXPECT_GE(x(0, 1), 1e-3 - 1e-8);
    EXPECT_GE((x(0, 0) + x(0, 1)) / std::sqrt(2.0), 1e-3 - 1e-8);
}

TEST(ResolvePenetration, TheContactsAreThoseOfTheResult) {
    const Boundary boundary = boundary_of({mesh_obstacle(icosphere(2))});
    std::mt19937 random(4);
    Points x = random_points(random, 300, 0.9);
    Proximity proximity({0.5, 0});
    SurfaceContacts contacts, expected;
    resolve_penetration(proximity, boundary, 1e-3, x, contacts);
    proximity.query(x, boundary, expected, StepEnd::end);
    EXPECT_EQ(contacts.distance, expected.distance);
    EXPECT_EQ(contacts.point1, expected.point1);
}

TEST(ResolvePenetration, OutsideNothingMoves) {
    Points x(2, 3);
    x << 1.2, 0, 0, 5, 5, 5;
    const Points before = x;
    Proximity proximity({0.5, 0});
    const ResolveReport report =
        resolve_penetration(proximity, boundary_of({mesh_obstacle(cube())}), 1e-3, x);
    EXPECT_EQ(x, before);
    EXPECT_EQ(report.moved + report.iterations, 0);
    EXPECT_EQ(report.max_depth_before, 0.0);
    EXPECT_EQ(resolve_penetration(proximity, Boundary(), 1e-3, x).moved, 0);
}

}  // namespace
}  // namespace cloth::resolve_test
