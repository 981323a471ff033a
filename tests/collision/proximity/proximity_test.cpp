#include "collision/proximity/proximity.h"

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "collision/proximity/direction.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/core/primitives.h"
#include "data/files/mesh_io.h"
#include "tests/collision/random_primitives.h"
#include "tests/sanitized.h"
#include "tests/test_meshes.h"

namespace cloth::proximity_test {
namespace {

using namespace test;

/// Compares a query with the oracle; returns how many points were found and how many inside.
std::pair<int, int> expect_equals_brute_force(const Points& x, const Boundary& boundary,
                                              double radius, double tolerance = 1e-12) {
    Proximity proximity({radius, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary, contacts);
    int found = 0, inside = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Vec3 q = x.row(i);
        const double expected = brute_force_signed_distance(boundary, StepEnd::start, q);
        EXPECT_EQ(contacts.has(i), std::abs(expected) <= radius) << "point " << i;
        if (!contacts.has(i)) continue;
        ++found, inside += expected < 0;
        EXPECT_NEAR(contacts.distance[i], expected, tolerance) << "point " << i;
        EXPECT_NEAR((contacts.point0.row(i) - x.row(i)).norm(), std::abs(expected), tolerance);
        EXPECT_NEAR(contacts.barycentric.row(i).sum(), 1.0, 1e-12);
    }
    return {found, inside};
}

TEST(Proximity, EqualsBruteForceOnRandomMeshes) {
    std::mt19937 random(1);
    for (const TriMesh& mesh :
         {icosphere(0), cube(), roughened(icosphere(2), 0.3, 2), torus(40, 20, 0.8, 0.3),
          roughened(torus(15, 7, 0.8, 0.3), 0.2, 3)}) {
        const auto [found, inside] = expect_equals_brute_force(
            random_points(random, 1000, 1.3), boundary_of({mesh_obstacle(mesh)}), 0.4);
        EXPECT_GT(found, 200);
        EXPECT_GT(inside, 50);
    }
}

TEST(Proximity, PassesOverIgnoredSolids) {
    Obstacle ball = primitive(ObstacleShape::sphere, Vec3::Zero(), 0.05);
    ball.solid = 1u << 31;
    Obstacle mesh = mesh_obstacle(icosphere(3));
    mesh.x0 = mesh.x1 = 0.2 * mesh.x0;
    Boundary boundary = boundary_of({ball, mesh});
    Points x(2, 3);
    x << 0.22, 0, 0, 0.22, 0, 0;
    boundary.obstacles[0].radius = 0.21;
    boundary.ignored_limbs = {0, 1u << 31};
    Proximity proximity;
    SurfaceContacts contacts;
    proximity.query(x, boundary, contacts);
    EXPECT_EQ(contacts.obstacle, (std::vector<int>{0, 1}));
    boundary.obstacles[1].solid = 1u << 31;
    proximity.query(x, boundary, contacts);
    EXPECT_EQ(contacts.obstacle, (std::vector<int>{0, -1}));
}

/// Boxes are in single precision: far from the world's origin that must not show.
TEST(Proximity, EqualsBruteForceFarFromTheOrigin) {
    std::mt19937 random(4);
    TriMesh mesh = roughened(icosphere(2), 0.3, 2);
    Points x = random_points(random, 500, 1.3);
    const Vec3 far(3e4, -1e4, 2e4);
    mesh.vertices.rowwise() += far.transpose();
    x.rowwise() += far.transpose();
    expect_equals_brute_force(x, boundary_of({mesh_obstacle(mesh)}), 0.4, 1e-10);
}

TEST(Proximity, EqualsBruteForceOnTheHumanBody) {
    TriMesh body;
    try {
        body = load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    } catch (const LoadError& error) {
        GTEST_SKIP() << "needs Debian's assimp-testmodels: " << error.what();
    }
    // brute force takes 40 times as long under the sanitizers
    const Eigen::Index count = is_sanitized ? 40 : 300;
    std::mt19937 random(5);
    Points x(count, 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        x.row(i) = body.vertices.row(Eigen::Index(random() % size_t(body.vertices.rows()))) +
                   random_point(random, 0.04).transpose();
    const auto [found, inside] =
        expect_equals_brute_force(x, boundary_of({mesh_obstacle(body)}), 0.1);
    EXPECT_EQ(found, count);
    EXPECT_GT(inside, count / 6);
}

TEST(Proximity, PointsAreCarriedWithARigidMotion) {
    std::mt19937 random(6);
    const Pose motion = pose_of({0.1, 0.2, -0.3}, 0.7, {1, 2, 3});
    Obstacle obstacle = mesh_obstacle(roughened(icosphere(2), 0.2, 1));
    obstacle.x1 = transformed(obstacle.x0, motion);
    Proximity proximity({0.5, 0});
    SurfaceContacts contacts;
    const Points x = random_points(random, 300, 1.2);
    proximity.query(x, boundary_of({obstacle}), contacts);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        if (!contacts.has(i)) continue;
        const Vec3 p0 = contacts.point0.row(i), p1 = contacts.point1.row(i);
        const Vec3 n0 = contacts.normal0.row(i), n1 = contacts.normal1.row(i);
        EXPECT_LT((p1 - motion * p0).norm(), 1e-12);
        EXPECT_LT((n1 - motion.linear() * n0).norm(), 1e-12);
        EXPECT_LT((contacts.velocity(i, 0.5) - 2 * (p1 - p0)).norm(), 1e-12);
    }
}

TEST(Proximity, WhatSticksIsCarriedAtItsDistanceFromASurfaceThatTurns) {
    std::mt19937 random(6);
    const Pose start = pose_of({0.2, -0.1, 0.1}, 0.4, {3, 1, 2});
    Obstacle ball = primitive(ObstacleShape::sphere, Vec3::Zero(), 0.5);
    Obstacle capsule = primitive(ObstacleShape::capsule, {0.0, 0.4, 0.0}, 0.2);
    Obstacle mesh = mesh_obstacle(icosphere(3));
    const Points x = random_points(random, 300, 1.2);
    for (Obstacle obstacle : {ball, capsule, mesh})
        for (const double angle : {0.0, 0.3}) {
            const Pose motion = pose_of({0.1, 0.2, -0.3}, angle, {1, 2, 3});
            obstacle.pose0 = start;
            obstacle.pose1 = motion * start;
            if (obstacle.faces) obstacle.x1 = transformed(obstacle.x0, motion);
            Proximity proximity({0.5, 0});
            SurfaceContacts contacts;
            proximity.query(x, boundary_of({obstacle}), contacts);
            int found = 0;
            for (Eigen::Index i = 0; i < x.rows(); ++i) {
                // In front of a mesh's edges the face alone does not tell how the point turns.
                if (!contacts.has(i) || contacts.barycentric.row(i).minCoeff() == 0.0) continue;
                ++found;
                const Vec3 at = x.row(i), carried = carried_motion(contacts, i, x);
                EXPECT_LT((at + carried - motion * at).norm(), 1e-12);
                if (angle == 0.0) {
                    EXPECT_EQ(carried, contacts.velocity(i, 1.0)) << "to the bit";
                }
            }
            EXPECT_GT(found, 20);
        }
}

TEST(Proximity, PrimitivesCarryTheirPoints) {
    Obstacle box = primitive(ObstacleShape::box, {1, 1, 1}, 0.0);
    box.pose0 = pose_of({5, 0, 0});
    box.pose1 = pose_of({5, 0, 1}, M_PI / 2, {0, 1, 0});
    Points x(1, 3);
    x << 6.1, 0.5, 0.25;  // in front of the side +x, which turns to -z
    Proximity proximity({0.2, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary_of({box}), contacts);
    ASSERT_TRUE(contacts.has(0));
    EXPECT_EQ(contacts.face[0], -1);
    EXPECT_NEAR(contacts.distance[0], 0.1, 1e-12);
    EXPECT_TRUE(contacts.barycentric.row(0).isApprox(Vec3(1, 0.5, 0.25).transpose()));
    EXPECT_TRUE(contacts.point0.row(0).isApprox(Vec3(6, 0.5, 0.25).transpose()));
    EXPECT_TRUE(contacts.normal0.row(0).isApprox(Vec3(1, 0, 0).transpose()));
    EXPECT_TRUE(contacts.point1.row(0).isApprox(Vec3(5.25, 0.5, 0).transpose()));
    EXPECT_TRUE(contacts.normal1.row(0).isApprox(Vec3(0, 0, -1).transpose()));
}

TEST(Proximity, QueryAtTheEndIsTheQueryOfTheLaterSurface) {
    std::mt19937 random(7);
    Obstacle obstacle = mesh_obstacle(icosphere(2));
    obstacle.x1 = transformed(obstacle.x0, pose_of({0.3, 0, 0}, 0.4));
    Obstacle later = obstacle;
    std::swap(later.x0, later.x1);
    const Points x = random_points(random, 300, 1.3);
    Proximity proximity({0.3, 0});
    SurfaceContacts at_end, swapped;
    VectorX distance;
    proximity.query(x, boundary_of({obstacle}), at_end, StepEnd::end);
    proximity.query(x, boundary_of({later}), swapped, StepEnd::start);
    proximity.signed_distance(x, boundary_of({obstacle}), StepEnd::end, distance);
    EXPECT_EQ(at_end.distance, swapped.distance);
    EXPECT_EQ(at_end.distance, distance);
    EXPECT_EQ(at_end.point1, swapped.point0);
    EXPECT_EQ(at_end.point0, swapped.point1);
    EXPECT_EQ(at_end.normal1, swapped.normal0);
}

/// Over an edge, both faces are equally close; the one that the point is in front of is reported.
TEST(Proximity, NormalIsOfTheFaceMostSquarelyInFront) {
    Points x(2, 3);
    x << 1.3, 1.1, 0.1, 1.1, 1.3, 0.1;
    Proximity proximity({0.5, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary_of({mesh_obstacle(cube())}), contacts);
    EXPECT_EQ(Vec3(contacts.normal0.row(0)), Vec3(1, 0, 0));
    EXPECT_EQ(Vec3(contacts.normal0.row(1)), Vec3(0, 1, 0));
    EXPECT_LT((Vec3(contacts.point0.row(0)) - Vec3(1, 1, 0.1)).norm(), 1e-15);
    EXPECT_NEAR(contacts.distance[0], std::hypot(0.3, 0.1), 1e-15);
}

TEST(Proximity, SmallestSignedDistanceWinsAmongObstacles) {
    Obstacle near = mesh_obstacle(icosphere(3)), far = near;
    near.x0.array() *= 0.1;  // radius 0.1 around the origin
    near.x1 = near.x0;
    far.faces = std::make_shared<const Faces>(*far.faces);
    far.x0 = far.x1 = (near.x0.rowwise() + Eigen::RowVector3d(0.4, 0, 0)).eval();
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    floor.pose0 = floor.pose1 = pose_of({0, -0.15, 0});
    Points x(4, 3);
    x << 0.15, 0, 0,      // near
        0.28, 0, 0,       // far
        0.0, -0.14, 0,    // floor
        0.0, -0.05, 0.0;  // inside near: beats being 0.1 above the floor
    Proximity proximity({0.2, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary_of({near, far, floor}), contacts);
    EXPECT_EQ(contacts.obstacle, (std::vector<int>{0, 1, 2, 0}));
    EXPECT_NEAR(contacts.distance[2], 0.01, 1e-12);
    EXPECT_LT(contacts.distance[3], -0.04);
}

TEST(Proximity, AmongManyPrimitivesTheNearestIsThatOfEachAlone) {
    std::mt19937 random(12);
    Proximity proximity({0.1, 0});
    SurfaceContacts contacts;
    int inside = 0;
    for (int trial = 0; trial < 30; ++trial) {
        const Boundary boundary = random_primitives(random, trial);
        const Points x = random_points(random, 300, 0.8);
        for (const StepEnd end : {StepEnd::start, StepEnd::end}) {
            proximity.query(x, boundary, contacts, end);
            for (Eigen::Index i = 0; i < x.rows(); ++i) {
                double least = std::numeric_limits<double>::infinity();
                int nearest = -1;
                for (const Obstacle& shape : boundary.obstacles) {
                    const Pose& pose = end == StepEnd::start ? shape.pose0 : shape.pose1;
                    const double distance =
                        closest_on_primitive(shape, pose.inverse() * x.row(i).transpose()).distance;
                    if (distance >= least) continue;
                    least = distance;
                    nearest = static_cast<int>(&shape - boundary.obstacles.data());
                }
                EXPECT_EQ(contacts.clearance[i], least);
                EXPECT_EQ(contacts.obstacle[size_t(i)], least > 0.1 ? -1 : nearest);
                inside += least < 0.0;
            }
        }
    }
    EXPECT_GT(inside, 2000);
}

TEST(Proximity, BeyondTheRadiusThereIsNoContact) {
    Points x(3, 3);
    x << 1.21, 0, 0, 1.19, 0, 0, 0, 0, 0;
    Obstacle ball = mesh_obstacle(icosphere(4));
    Proximity proximity({0.2, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary_of({ball}), contacts);
    EXPECT_EQ(contacts.obstacle, (std::vector<int>{-1, 0, -1}));
    EXPECT_TRUE(contacts.point0.row(0).isZero(0.0));
    // A primitive knows its inside at any depth.
    proximity.query(x, boundary_of({primitive(ObstacleShape::sphere, Vec3::Zero(), 1.0)}),
                    contacts);
    EXPECT_EQ(contacts.obstacle, (std::vector<int>{-1, 0, 0}));
    EXPECT_DOUBLE_EQ(contacts.distance[2], -1.0);
}

TEST(Proximity, SomeRowsCanBeQueriedAgain) {
    std::mt19937 random(8);
    const Boundary boundary = boundary_of({mesh_obstacle(icosphere(2))});
    Points x = random_points(random, 100, 1.2);
    Proximity proximity({0.4, 0});
    SurfaceContacts contacts, all;
    proximity.query(x, boundary, contacts);
    const SurfaceContacts before = contacts;
    x = random_points(random, 100, 1.2);
    proximity.query_rows(x, {3, 50}, boundary, contacts);
    proximity.query(x, boundary, all);
    for (Eigen::Index i = 0; i < 100; ++i)
        EXPECT_EQ(contacts.distance[i], (i == 3 || i == 50 ? all : before).distance[i]);
}

}  // namespace
}  // namespace cloth::proximity_test
