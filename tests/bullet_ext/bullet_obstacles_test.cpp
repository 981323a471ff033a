#include <gtest/gtest.h>

#include <limits>

#include "bullet_ext/bulletObstacles.h"
#include "data/core/errors.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::bullet_obstacles_test {

using namespace cloth::test;

namespace {

/// A world with a level patch at the origin whose stepper writes down what it is told.
struct Scene {
    std::shared_ptr<FreeFall::Log> log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth;

    explicit Scene(double fixed_dt = 0.0) : solver(free_fall(log, fixed_dt)), world(&solver) {
        world.info().m_gravity.setZero();
        cloth = world.add(patch(world.info(), {0, 0, 0}));
    }
    const std::vector<Obstacle>& obstacles() const { return log->boundaries.back().obstacles; }
    Vec3 begin() const { return obstacles().at(0).pose0.translation(); }
    Vec3 end() const { return obstacles().at(0).pose1.translation(); }
};

void move(btRigidBody* body, const btVector3& by) {
    btTransform t = body->getWorldTransform();
    t.getOrigin() += by;
    body->setWorldTransform(t);
}

std::shared_ptr<const Faces> one_face() {
    Faces faces(1, 3);
    faces << 0, 1, 2;
    return std::make_shared<const Faces>(faces);
}

Points triangle(double y) {
    Points x(3, 3);
    x << 0, y, 0, 1, y, 0, 0, y, 1;
    return x;
}

}  // namespace

TEST(BulletObstacles, OnlyNearObjectsWithSurfaceAreSeen) {
    Scene scene;
    scene.world.add(new btSphereShape(0.1f), {0, 0.15f, 0});
    scene.world.add(new btSphereShape(0.1f), {0, 5, 0});
    btRigidBody* ghost = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
    ghost->setCollisionFlags(ghost->getCollisionFlags() |
                             btCollisionObject::CF_NO_CONTACT_RESPONSE);
    scene.world.step(1.0 / 60.0);
    ASSERT_EQ(scene.obstacles().size(), 1u);
    EXPECT_NEAR(scene.end().y(), 0.15, 1e-6);
}

TEST(BulletObstacles, FrictionIsTheProductOfBoth) {
    Scene scene;
    scene.cloth->m_cfg.kDF = 0.5f;
    scene.world.add(new btSphereShape(0.1f), {0, 0, 0})->setFriction(0.8f);
    scene.world.step(1.0 / 60.0);
    EXPECT_NEAR(scene.obstacles()[0].friction, 0.4, 1e-6);
}

TEST(BulletObstacles, CollisionFiltersAreRespected) {
    Scene scene;
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
    sphere->getBroadphaseHandle()->m_collisionFilterMask = 0;
    btRigidBody* ignored = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
    scene.cloth->setIgnoreCollisionCheck(ignored, true);
    btRigidBody* disabled = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
    scene.cloth->m_collisionDisabledObjects.push_back(disabled);
    scene.world.step(1.0 / 60.0);
    EXPECT_TRUE(scene.obstacles().empty());
}

TEST(BulletObstacles, KinematicBodyMovesFromItsLastPoseToItsNewOne) {
    Scene scene;
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.begin(), scene.end());
    for (int i = 1; i <= 3; ++i) {
        move(sphere, {0.01f, 0, 0});
        scene.world.step(1.0 / 60.0);
        EXPECT_NEAR(scene.begin().x(), 0.01 * (i - 1), 1e-6);
        EXPECT_NEAR(scene.end().x(), 0.01 * i, 1e-6);
    }
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.begin(), scene.end());
}

TEST(BulletObstacles, JumpOfAKinematicBodyIsSpreadOverTheSubSteps) {
    Scene scene;
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    scene.world->stepSimulation(1.0f / 30, 8, 1.0f / 240);
    for (int call = 0; call < 3; ++call) {
        move(sphere, {0.08f, 0, 0});
        scene.log->boundaries.clear();
        scene.world->stepSimulation(1.0f / 30, 8, 1.0f / 240);
        ASSERT_EQ(scene.log->boundaries.size(), 8u);
        for (int i = 0; i < 8; ++i) {
            const Obstacle& o = scene.log->boundaries[static_cast<size_t>(i)].obstacles.at(0);
            EXPECT_NEAR(o.pose0.translation().x(), 0.08 * call + 0.01 * i, 1e-5);
            EXPECT_NEAR(o.pose1.translation().x(), 0.08 * call + 0.01 * (i + 1), 1e-5);
        }
    }
}

TEST(BulletObstacles, TurningIsInterpolatedToo) {
    Scene scene;
    btRigidBody* box = scene.world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {0, 0, 0}, true);
    scene.world->stepSimulation(1.0f / 30, 4, 1.0f / 120);
    btTransform t = box->getWorldTransform();
    t.setRotation(btQuaternion({0, 1, 0}, 0.4f));
    box->setWorldTransform(t);
    scene.log->boundaries.clear();
    scene.world->stepSimulation(1.0f / 30, 4, 1.0f / 120);
    for (size_t i = 0; i < 4; ++i) {
        const Obstacle& o = scene.log->boundaries.at(i).obstacles.at(0);
        const Eigen::AngleAxisd turn(o.pose1.linear());
        EXPECT_NEAR(turn.angle(), 0.1 * static_cast<double>(i + 1), 1e-3);
    }
}

TEST(BulletObstacles, ATickLooksAheadWithTheObstaclesVelocity) {
    Scene scene(1.0 / 30.0);
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    for (int i = 0; i < 16; ++i) {
        move(sphere, {0.01f, 0, 0});
        scene.world.step(1.0 / 240.0);
    }
    ASSERT_EQ(scene.log->boundaries.size(), 2u);
    EXPECT_NEAR(scene.begin().x(), 0.08, 1e-5);
    EXPECT_NEAR(scene.end().x(), 0.16, 1e-5);
}

TEST(BulletObstacles, DynamicBodiesAreObstaclesToo) {
    Scene scene;
    scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, false, 1);
    scene.world.step(0.1);
    EXPECT_NEAR(scene.begin().y(), 0.0, 1e-6);
    EXPECT_NEAR(scene.end().y(), -0.0981, 1e-5);
}

TEST(NearSolid, BeyondTheRadiusThereIsNoDistanceAndNoWayOut) {
    btSphereShape sphere(0.1f);
    const btConvexHullShape cube = [] {
        btConvexHullShape hull;
        for (int i = 0; i < 8; ++i)
            hull.addPoint({i & 1 ? 0.1f : -0.1f, i & 2 ? 0.1f : -0.1f, i & 4 ? 0.1f : -0.1f});
        return hull;
    }();
    for (const btCollisionShape* shape : {static_cast<const btCollisionShape*>(&sphere),
                                          static_cast<const btCollisionShape*>(&cube)}) {
        std::vector<PartDistance> parts;
        for (const ShapePart& part : partsOfShape(*shape)) parts.emplace_back(part);
        NearSolid solid;
        solid.parts = &parts;
        const Vec3 near(0, 0.103, 0), inside(0, 0.09, 0), far(0, 0.106, 0);
        EXPECT_NEAR(solid.distance(near, 5e-3).value(), 0.003, 1e-7);
        EXPECT_NEAR(solid.distance(inside, 0.02).value(), -0.01, 1e-7);
        EXPECT_LT((solid.outward(near, 5e-3) - Vec3::UnitY()).norm(), 1e-6);
        EXPECT_FALSE(solid.distance(far, 5e-3));
        EXPECT_EQ(solid.outward(far, 5e-3), Vec3(Vec3::Zero()));
        parts.clear();
        EXPECT_FALSE(solid.distance(near, 5e-3)) << "a shape without surface is nowhere";
    }
}

TEST(BulletObstacles, RemovedAndReshapedBodiesAreFollowed) {
    Scene scene;
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
    scene.world.step(1.0 / 60.0);
    btBoxShape box({0.2f, 0.2f, 0.2f});
    sphere->setCollisionShape(&box);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).shape, ObstacleShape::box);
    scene.world->removeRigidBody(sphere);
    scene.world.step(1.0 / 60.0);
    EXPECT_TRUE(scene.obstacles().empty());
}

TEST(BulletObstacles, MeshKeepsItsFacesPointer) {
    Scene scene;
    btTriangleMesh mesh;
    mesh.addTriangle({0, 0, 0}, {1, 0, 0}, {0, 0, 1});
    btRigidBody* body =
        scene.world.add(new btBvhTriangleMeshShape(&mesh, true), {0, 0.1f, 0}, true);
    scene.world.step(1.0 / 60.0);
    const auto faces = scene.obstacles().at(0).faces;
    move(body, {0, 0.01f, 0});
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).faces, faces);
    EXPECT_NEAR(scene.obstacles()[0].x0(0, 1), 0.1, 1e-6);
    EXPECT_NEAR(scene.obstacles()[0].x1(0, 1), 0.11, 1e-6);
}

TEST(BulletObstacles, ShapesWithoutSurfaceAreReportedOnce) {
    Scene scene;
    scene.world.add(new btCompoundShape(), {0, 0, 0});
    scene.world.step(1.0 / 60.0, 3);
    ASSERT_EQ(scene.solver.status().messages.size(), 1u);
    EXPECT_EQ(scene.solver.status().messages[0].count, 1);
}

TEST(BulletObstacles, AnimatedMeshReplacesTheShapeAndIsInterpolated) {
    Scene scene;
    btRigidBody* handle = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    const auto faces = one_face();
    for (int frame = 0; frame < 3; ++frame) {
        scene.solver.setAnimatedObstacle(handle, faces, triangle(0.01 * frame),
                                         triangle(0.01 * (frame + 1)), 1.0 / 30.0);
        scene.log->boundaries.clear();
        scene.world->stepSimulation(1.0f / 30, 2, 1.0f / 60);
        ASSERT_EQ(scene.log->boundaries.size(), 2u);
        for (size_t i = 0; i < 2; ++i) {
            const auto& obstacles = scene.log->boundaries[i].obstacles;
            ASSERT_EQ(obstacles.size(), 1u);
            EXPECT_EQ(obstacles[0].faces, faces);
            const double start = 0.01 * frame + 0.005 * static_cast<double>(i);
            EXPECT_NEAR(obstacles[0].x0(0, 1), start, 1e-7);
            EXPECT_NEAR(obstacles[0].x1(0, 1), start + 0.005, 1e-7);
        }
    }
    scene.world.step(1.0 / 60.0);  // not given anew: it stands
    EXPECT_EQ(scene.obstacles().at(0).x0, scene.obstacles().at(0).x1);
    scene.solver.removeAnimatedObstacle(handle);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).shape, ObstacleShape::sphere);
}

TEST(BulletObstacles, LimbsOfAnAnimatedMeshReachTheStepper) {
    Scene scene;
    btRigidBody* handle = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    const auto limbs = std::make_shared<const std::vector<std::uint8_t>>(1, std::uint8_t(3));
    scene.solver.setAnimatedObstacle(handle, one_face(), triangle(0), triangle(0), 0.0, limbs);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).limbs, limbs);
    for (const std::vector<std::uint8_t>& wrong : {std::vector<std::uint8_t>{1, 2}, {32}, {}})
        EXPECT_THROW(scene.solver.setAnimatedObstacle(
                         handle, one_face(), triangle(0), triangle(0), 0.0,
                         std::make_shared<const std::vector<std::uint8_t>>(wrong)),
                     ArgumentError);
}

TEST(BulletObstacles, BadAnimatedMeshesAreRefused) {
    Scene scene;
    btRigidBody* handle = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    const auto set = [&](std::shared_ptr<const Faces> faces, Points x0, Points x1) {
        scene.solver.setAnimatedObstacle(handle, faces, x0, x1);
    };
    EXPECT_THROW(set(nullptr, triangle(0), triangle(0)), ArgumentError);
    EXPECT_THROW(set(one_face(), triangle(0), Points(2, 3)), ArgumentError);
    EXPECT_THROW(set(one_face(), Points::Zero(2, 3), Points::Zero(2, 3)), ArgumentError);
    const Points nan = triangle(std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(set(one_face(), nan, nan), ArgumentError);
}

}  // namespace cloth::bullet_obstacles_test
