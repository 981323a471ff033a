// What follows the nodes of a soft body, such as a finer mesh to be drawn.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "bullet_ext/softBodyGarment.h"
#include "collision/proximity/proximity.h"
#include "collision/response/embedded_mesh.h"
#include "data/core/errors.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/test_meshes.h"

namespace cloth::follower_test {

using namespace cloth::test;

namespace {

btGnnSolverSettings of_soft_cotton() {
    btGnnSolverSettings settings;
    settings.fabric = Fabric::soft_cotton();
    return settings;
}

/// A sheet of 1 m and 13 x 13 nodes, followed by one of 40 x 40 vertices.
class FollowedSheet : public testing::Test {
 protected:
    FollowedSheet()
        : solver([](const Garment& garment) { return make_cloth(garment); }, of_soft_cotton()),
          world(&solver) {}

    void hang(int pins) {
        cloth = world.add(patch(world.info(), {0, 0, 0}, 13, pins));
        solver.attach(cloth);
        TriMesh fine = square_mesh(40);
        fine.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.0, 0.5);
        drawn = std::make_shared<EmbeddedMesh>(solver.garmentOf(cloth)->rest(), fine);
        solver.follow(cloth, drawn);
    }
    /// From where the nodes alone would put it (m).
    double distance_to_embedding() const {
        Points x;
        drawn->embedding().positions(nodePositions(*cloth), x);
        return (drawn->vertices() - x).rowwise().norm().maxCoeff();
    }
    bool was_said(const std::string& words) const {
        for (const btGnnSolverMessage& message : solver.status().messages)
            if (message.text.find(words) != std::string::npos) return true;
        return false;
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth = nullptr;
    std::shared_ptr<EmbeddedMesh> drawn;
};

}  // namespace

TEST_F(FollowedSheet, ItIsWhereTheNodesAreAfterEachStep) {
    hang(1 + 2);
    EXPECT_LT(distance_to_embedding(), 1e-6) << "before the first step, too";
    for (int k = 0; k < 120; ++k) {
        world.step(1.0 / 60.0);
        ASSERT_LT(distance_to_embedding(), 1e-6) << k;
    }
    EXPECT_LT(drawn->vertices().col(1).minCoeff(), -0.3) << "it does not hang";
    EXPECT_NEAR(drawn->normals().row(0).norm(), 1.0, 1e-9);
    EXPECT_EQ(solver.followerOf(cloth), drawn.get());
}

TEST_F(FollowedSheet, ItIsInterpolatedAsTheNodesAre) {
    hang(1 + 2);
    // A stepper with a time step of its own shows the nodes in between.
    solver.attach(cloth, *solver.garmentOf(cloth), free_fall(nullptr, 1.0 / 30.0));
    for (int k = 0; k < 8; ++k) {
        world.step(1.0 / 120.0);
        ASSERT_LT(distance_to_embedding(), 1e-6) << k;
    }
}

TEST_F(FollowedSheet, NoVertexIsInsideAnObstacleAsItIsNow) {
    btRigidBody* ball = world.add(new btSphereShape(0.25f), {0.03f, -0.28f, 0.01f}, true);
    hang(0);
    for (int k = 0; k < 90; ++k) {
        ball->getWorldTransform().getOrigin().setX(0.03f + 0.1f * std::sin(0.1f * float(k)));
        world.step(1.0 / 60.0);
        const Vec3 centre = toVec3(ball->getWorldTransform().getOrigin());
        const double nearest =
            (drawn->vertices().rowwise() - centre.transpose()).rowwise().norm().minCoeff();
        ASSERT_GE(nearest, 0.25) << k;
    }
    EXPECT_LT(drawn->vertices().col(1).minCoeff(), -0.1) << "it does not drape";
}

TEST_F(FollowedSheet, AnAnimatedSkinPushesItToo) {
    const TriMesh ball = icosphere(4);
    const auto faces = std::make_shared<const Faces>(ball.faces);
    btSphereShape shape(0.1f);
    btCollisionObject person;
    person.setCollisionShape(&shape);
    person.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    person.getWorldTransform().setIdentity();
    world->addCollisionObject(&person);
    const auto skin = [&](int frame) {
        Points x = 0.25 * ball.vertices;
        x.col(1).array() += -0.27 + 0.002 * frame;
        return x;
    };
    hang(0);
    Proximity proximity;
    for (int k = 0; k < 60; ++k) {
        solver.setAnimatedObstacle(&person, faces, skin(k), skin(k + 1), 1.0 / 60.0);
        world.step(1.0 / 60.0);
        Boundary boundary;
        boundary.obstacles.resize(1);
        boundary.obstacles[0].faces = faces;
        boundary.obstacles[0].x0 = boundary.obstacles[0].x1 = skin(k + 1);
        VectorX distance;
        proximity.signed_distance(drawn->vertices(), boundary, StepEnd::end, distance);
        ASSERT_GE(distance.minCoeff(), -1e-6) << k;
    }
    solver.removeAnimatedObstacle(&person);
    world->removeCollisionObject(&person);
}

TEST_F(FollowedSheet, ItFollowsTeleportScaleAndNewPins) {
    hang(1 + 2);
    world.step(1.0 / 60.0, 20);
    btTransform motion(btQuaternion({0, 1, 0}, 0.7f), {3, 1, 2});
    const Points before = drawn->vertices();
    solver.teleport(cloth, motion);
    const Pose pose = toPose(motion);
    const Points expected =
        (before * pose.linear().transpose()).rowwise() + pose.translation().transpose();
    EXPECT_LT((drawn->vertices() - expected).rowwise().norm().maxCoeff(), 1e-5)
        << "at once, before the next step";
    world.step(1.0 / 60.0, 2);
    EXPECT_LT(distance_to_embedding(), 1e-6);

    cloth->setMass(6, 0);
    world.step(1.0 / 60.0, 2);
    EXPECT_LT(distance_to_embedding(), 1e-6);
    cloth->scale({1.5f, 1.5f, 1.5f});
    world.step(1.0 / 60.0, 2);
    EXPECT_LT(distance_to_embedding(), 1e-6);
    EXPECT_EQ(solver.followerOf(cloth), drawn.get());
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST_F(FollowedSheet, ItFollowsWhatBulletSteps) {
    hang(1 + 2);
    world.step(1.0 / 60.0, 5);
    solver.detach(cloth);
    const Points before = drawn->vertices();
    world.step(1.0 / 60.0, 10);
    EXPECT_EQ(solver.status().bulletBodies, 1);
    EXPECT_LT(distance_to_embedding(), 1e-6);
    EXPECT_GT((drawn->vertices() - before).rowwise().norm().maxCoeff(), 0.01);
}

TEST_F(FollowedSheet, ACutEndsItWithAMessage) {
    hang(1 + 2);
    world.step(1.0 / 60.0, 5);
    struct Ball : btSoftBody::ImplicitFn {
        btScalar Eval(const btVector3& x) override {
            return btVector3(x.x(), 0, x.z()).length() - btScalar(0.2);
        }
    } ball;
    const int nodes = cloth->m_nodes.size();
    cloth->refine(&ball, 1e-4f, /*cut=*/true);
    ASSERT_GT(cloth->m_nodes.size(), nodes);
    const Points before = drawn->vertices();
    world.step(1.0 / 60.0, 2);
    EXPECT_EQ(solver.followerOf(cloth), nullptr);
    EXPECT_EQ(drawn->vertices(), before);
    EXPECT_TRUE(was_said("the mesh that follows it"));
    EXPECT_TRUE(was_said("call follow()"));
}

TEST_F(FollowedSheet, ItEndsWhenTheBodyLeavesTheWorld) {
    hang(1 + 2);
    world.step(1.0 / 60.0, 5);
    world->removeSoftBody(cloth);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.followerOf(cloth), nullptr);
    world->addSoftBody(cloth);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.followerOf(cloth), nullptr);
}

TEST_F(FollowedSheet, NodesAtNanLeaveItWhereItIs) {
    hang(1 + 2);
    world.step(1.0 / 60.0, 5);
    cloth->m_nodes[80].m_x.setY(std::numeric_limits<float>::quiet_NaN());
    world.step(1.0 / 60.0);
    EXPECT_TRUE(drawn->vertices().allFinite());
    world.step(1.0 / 60.0, 3);
    EXPECT_LT(distance_to_embedding(), 1e-6);
}

TEST_F(FollowedSheet, BadInputIsRefusedByName) {
    hang(1 + 2);
    btSoftBody* small = world.add(patch(world.info(), {3, 0, 0}, 5, 1));
    for (const auto& [body, word] : {std::pair<btSoftBody*, std::string>(nullptr, "null"),
                                     std::pair<btSoftBody*, std::string>(small, "169 vertices")}) {
        try {
            solver.follow(body, drawn);
            ADD_FAILURE() << word;
        } catch (const ArgumentError& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("Remedy"), std::string::npos);
        }
    }
    EXPECT_EQ(solver.followerOf(small), nullptr);
    solver.follow(cloth, nullptr);
    EXPECT_EQ(solver.followerOf(cloth), nullptr);
    world.step(1.0 / 60.0, 2);
}

}  // namespace cloth::follower_test
