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

TEST(BulletObstacles, FrictionThatIsNoneCountsAsZeroAndIsTold) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinite = std::numeric_limits<float>::infinity();
    for (const float none : {nan, -1.0f, -infinite}) {
        Scene scene;
        scene.cloth->m_cfg.kDF = 0.5f;
        btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
        sphere->setUserIndex(7);
        sphere->setFriction(none);
        scene.world.step(1.0 / 60.0, 3);
        EXPECT_EQ(scene.obstacles().at(0).friction, 0.0);
        ASSERT_EQ(scene.solver.status().messages.size(), 1u);
        const std::string& text = scene.solver.status().messages[0].text;
        for (const char* part : {"collision object 7 at ", "its friction is negative", "Remedy: "})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
    for (const float none : {nan, -1.0f, -infinite}) {
        Scene scene;
        scene.cloth->m_cfg.kDF = none;
        scene.world.add(new btSphereShape(0.1f), {0, 0, 0})->setFriction(0.8f);
        scene.world.step(1.0 / 60.0);
        EXPECT_EQ(scene.obstacles().at(0).friction, 0.0);
        ASSERT_EQ(scene.solver.status().messages.size(), 1u);
        EXPECT_NE(scene.solver.status().messages[0].text.find("kDF is negative"),
                  std::string::npos);
    }
}

TEST(BulletObstacles, InfiniteFrictionIsALargeOne) {
    constexpr float infinite = std::numeric_limits<float>::infinity();
    for (const float large : {1e4f, std::numeric_limits<float>::max(), infinite}) {
        Scene scene;
        btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {0, 0, 0});
        sphere->setFriction(large);
        scene.cloth->m_cfg.kDF = large;
        scene.world.step(1.0 / 60.0);
        EXPECT_EQ(scene.obstacles().at(0).friction, kMostFriction);
        scene.cloth->m_cfg.kDF = 0;
        scene.world.step(1.0 / 60.0);
        EXPECT_EQ(scene.obstacles().at(0).friction, 0.0);
        EXPECT_TRUE(scene.solver.status().messages.empty());
    }
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

TEST(BulletObstacles, StaticObjectThatIsPutElsewhereJumps) {
    Scene scene;
    btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {-0.2f, 0, 0});
    scene.world.step(1.0 / 60.0, 2);
    move(sphere, {0.4f, 0, 0});
    scene.world->updateSingleAabb(sphere);
    scene.world.step(1.0 / 60.0);
    EXPECT_NEAR(scene.begin().x(), 0.2, 1e-6);
    EXPECT_EQ(scene.begin(), scene.end());
}

TEST(BulletObstacles, BodyThatCameBackElsewhereJumps) {
    for (const int kind : {0, 1, 2}) {
        Scene scene;
        btRigidBody* sphere = scene.world.add(new btSphereShape(0.1f), {-0.2f, 0, 0}, kind == 1,
                                              kind == 2 ? 1.0f : 0.0f);
        sphere->setGravity({0, 0, 0});
        scene.world.step(1.0 / 60.0, 2);
        for (const int steps_away : {0, 3}) {
            const double before = scene.end().x();
            scene.world->removeRigidBody(sphere);
            scene.world.step(1.0 / 60.0, steps_away);
            move(sphere, {0.4f, 0, 0});
            scene.world->addRigidBody(sphere);
            sphere->setGravity({0, 0, 0});
            scene.world.step(1.0 / 60.0);
            EXPECT_NEAR(scene.begin().x(), before + 0.4, 1e-4) << kind << " " << steps_away;
            EXPECT_NEAR(scene.end().x(), before + 0.4, 1e-4) << kind << " " << steps_away;
            scene.world.step(1.0 / 60.0);
            EXPECT_LT((scene.end() - scene.begin()).norm(), 1e-4);
        }
        // What it does from now on is its motion.
        if (kind != 1) continue;
        move(sphere, {0.01f, 0, 0});
        scene.world.step(1.0 / 60.0);
        EXPECT_NEAR(scene.end().x() - scene.begin().x(), 0.01, 1e-6);
    }
}

/// As in a program that deletes one and makes another, and gets the same memory again.
TEST(BulletObstacles, BodyAtTheAddressOfAnotherIsAnotherOne) {
    alignas(btRigidBody) unsigned char place[sizeof(btRigidBody)];
    alignas(btSphereShape) unsigned char shape_place[sizeof(btSphereShape)];
    Scene scene;
    const auto make = [&](btScalar radius, const btVector3& at) {
        auto* shape = new (shape_place) btSphereShape(radius);
        auto* body = new (place) btRigidBody(1, nullptr, shape, {1, 1, 1});
        body->setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
        body->setInterpolationWorldTransform(body->getWorldTransform());
        scene.world->addRigidBody(body);
        body->setGravity({0, 0, 0});
        return body;
    };
    btRigidBody* body = make(0.1f, {-0.2f, 0, 0});
    scene.world.step(1.0 / 60.0, 2);
    EXPECT_NEAR(scene.end().x(), -0.2, 1e-6);
    scene.world->removeRigidBody(body);
    body->~btRigidBody();
    body = make(0.15f, {0.2f, 0, 0});
    scene.world.step(1.0 / 60.0);
    EXPECT_NEAR(scene.begin().x(), 0.2, 1e-6);
    EXPECT_NEAR(scene.end().x(), 0.2, 1e-6);
    EXPECT_NEAR(scene.obstacles().at(0).radius, 0.15, 1e-6);
    scene.world->removeRigidBody(body);
    body->~btRigidBody();
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

TEST(BulletObstacles, ChildOfACompoundThatMovesIsFollowed) {
    btSphereShape post(0.05f), platform(0.1f);
    auto* compound = new btCompoundShape;
    const auto at = [](const btVector3& place) {
        return btTransform(btQuaternion::getIdentity(), place);
    };
    compound->addChildShape(at({-1, 0, 0}), &post);
    compound->addChildShape(at({1, 0, 0}), &post);
    compound->addChildShape(at({0, 0, 0}), &platform);
    Scene scene;
    scene.world.add(compound, {0, 0, 0});
    scene.world.step(1.0 / 60.0);
    const auto place = [&] {
        for (const Obstacle& obstacle : scene.obstacles())
            if (obstacle.radius > 0.07) return obstacle.pose1.translation().x();
        return std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_NEAR(place(), 0.0, 1e-6);
    compound->updateChildTransform(2, at({0.5f, 0, 0}));
    scene.world.step(1.0 / 60.0);
    EXPECT_NEAR(place(), 0.5, 1e-6);
}

TEST(BulletObstacles, AnotherMeshWithTheSameBoxIsFollowed) {
    const auto two_of = [](const btVector3& corner, btTriangleMesh& mesh) {
        mesh.addTriangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
        mesh.addTriangle({1, 0, 1}, {1, 0, 0}, corner);
    };
    btTriangleMesh square, slit;
    two_of({0, 0, 1}, square);
    two_of({0.5f, 0, 1}, slit);
    btBvhTriangleMeshShape other(&slit, true);
    Scene scene;
    btRigidBody* body = scene.world.add(new btBvhTriangleMeshShape(&square, true), {0, 0.1f, 0});
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).x1.rows(), 4);
    body->setCollisionShape(&other);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().at(0).x1.rows(), 5);
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

TEST(BulletObstacles, AnAnimatedMeshThatJumpsAwayFromClothIsTold) {
    Scene scene;
    btRigidBody* handle = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    const auto faces = one_face();
    const auto give = [&](double from, double to) {
        scene.solver.setAnimatedObstacle(handle, faces, triangle(from), triangle(to), 1.0 / 60.0);
        scene.world.step(1.0 / 60.0);
        return scene.solver.status().messages.size();
    };
    give(0.0, 0.0);
    EXPECT_EQ(give(0.0, 0.6), 0u) << "it goes there in a step";
    EXPECT_EQ(give(0.6, 0.0), 0u);
    EXPECT_EQ(give(0.4, 0.4), 0u);
    EXPECT_EQ(give(0.0, 0.0), 0u);
    EXPECT_EQ(give(9.0, 9.0), 1u);
    EXPECT_NE(scene.solver.status().messages[0].text.find("teleport()"), std::string::npos);
    EXPECT_EQ(give(0.0, 0.0), 1u) << "no cloth is where it was";
    EXPECT_EQ(scene.solver.status().messages[0].count, 1);
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.solver.status().messages[0].count, 1) << "it was not given anew";
    scene.solver.teleport(scene.cloth, btTransform::getIdentity());
    give(9.0, 9.0);
    EXPECT_EQ(scene.solver.status().messages[0].count, 1) << "its cloth was put elsewhere, too";
}

TEST(BulletObstacles, AnimatedMeshLeavesTheWorldWithItsObject) {
    Scene scene;
    btRigidBody* handle = scene.world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    const auto faces = one_face();
    const auto give = [&] {
        scene.solver.setAnimatedObstacle(handle, faces, triangle(0), triangle(0));
    };
    give();
    scene.world.step(1.0 / 60.0);
    EXPECT_EQ(scene.obstacles().size(), 1u);
    scene.world->removeRigidBody(handle);
    scene.world.step(1.0 / 60.0);
    EXPECT_TRUE(scene.obstacles().empty());
    give();
    scene.world.step(1.0 / 60.0);
    EXPECT_TRUE(scene.obstacles().empty());
    scene.world->addRigidBody(handle);
    scene.world.step(1.0 / 60.0);
    ASSERT_EQ(scene.obstacles().size(), 1u);
    EXPECT_EQ(scene.obstacles()[0].faces, faces);
}

TEST(BulletObstacles, AnimatedMeshOfAnObjectThatNeverWasInAWorldActs) {
    Scene scene;
    btSphereShape shape(0.1f);
    btCollisionObject handle;
    handle.setCollisionShape(&shape);
    handle.setWorldTransform(btTransform::getIdentity());
    scene.solver.setAnimatedObstacle(&handle, one_face(), triangle(0), triangle(0));
    scene.world.step(1.0 / 60.0, 2);
    EXPECT_EQ(scene.obstacles().size(), 1u);
    scene.solver.removeAnimatedObstacle(&handle);
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
    const auto set = [&](std::shared_ptr<const Faces> faces, Points x0, Points x1, double h = 0) {
        scene.solver.setAnimatedObstacle(handle, faces, x0, x1, h);
    };
    EXPECT_THROW(set(nullptr, triangle(0), triangle(0)), ArgumentError);
    EXPECT_THROW(set(one_face(), triangle(0), Points(2, 3)), ArgumentError);
    EXPECT_THROW(set(one_face(), Points::Zero(2, 3), Points::Zero(2, 3)), ArgumentError);
    const Points nan = triangle(std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(set(one_face(), nan, nan), ArgumentError);
    for (const double h :
         {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(set(one_face(), triangle(0), triangle(0), h), ArgumentError);
}

}  // namespace cloth::bullet_obstacles_test
