// Every body a user may hand over by mistake gets a documented answer: it is stepped as cloth, or
// Bullet steps it and a message names body, place and remedy. Nothing crashes, nothing freezes the
// world.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"

namespace cloth::bad_input_test {

using namespace cloth::test;

namespace {

constexpr btScalar kNan = std::numeric_limits<btScalar>::quiet_NaN();

class BadInput : public testing::Test {
 protected:
    BadInput() : solver(quasi_newton(1.0 / 30.0, 3)), world(&solver) {
        world.add(new btBoxShape({2, 0.5f, 2}), {0, -1.5f, 0});
        healthy = world.add(patch(world.info(), {5, 0, 0}, 5));
    }
    /// Steps for a while; the healthy cloth must fall, and all nodes stay finite.
    void run(btSoftBody* body) {
        body->setUserIndex(7);
        world.add(body);
        world.step(1.0 / 60.0, 40);
        EXPECT_LT(node(*healthy, 12).y(), -1.0);
        for (int i = 0; i < body->m_nodes.size(); ++i) ASSERT_TRUE(node(*body, i).allFinite()) << i;
    }
    std::string messages() const {
        std::string all;
        for (const btGnnSolverMessage& message : solver.status().messages)
            all += message.text + "\n";
        return all;
    }
    void expect_cloth() {
        EXPECT_EQ(messages(), "");
        EXPECT_EQ(solver.status().clothBodies, 2);
    }
    void expect_told(const std::string& place, const std::string& problem) {
        EXPECT_EQ(solver.status().clothBodies, 1);
        EXPECT_EQ(solver.status().messages.size(), 1u) << messages();
        for (const std::string& part :
             {std::string("soft body 7"), place, problem, std::string("Remedy: ")})
            EXPECT_NE(messages().find(part), std::string::npos) << part << " in: " << messages();
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* healthy;
};

}  // namespace

TEST_F(BadInput, ClosedClothIsClothIfItIsAttached) {
    btSoftBody* ball =
        btSoftBodyHelpers::CreateEllipsoid(world.info(), {0, 0, 0}, {0.3f, 0.3f, 0.3f}, 64);
    solver.attach(ball);
    run(ball);
    expect_cloth();
}

TEST_F(BadInput, UnconnectedPiecesAreCloth) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    const int first = body->m_nodes.size();
    for (int k = 0; k < 3; ++k) body->appendNode({1.5f + 0.1f * (k == 1), 0, 0.1f * (k == 2)}, 1);
    body->appendFace(first, first + 2, first + 1);
    run(body);
    expect_cloth();
    EXPECT_LT(node(*body, first).y(), -0.8);
}

TEST_F(BadInput, AWorldInCentimetresIsTold) {
    world.info().m_gravity = {0, -981, 0};
    healthy->setUserIndex(7);
    world.step(1.0 / 60.0, 2);
    expect_told("gravity is 981 m/s^2", "centimetres");
}

TEST_F(BadInput, GravityThatIsNoNumberCountsAsZeroAndIsTold) {
    for (const btScalar spoilt : {kNan, std::numeric_limits<btScalar>::infinity()}) {
        healthy->setUserIndex(7);
        world.step(1.0 / 60.0);
        const btVector3 before = healthy->m_nodes[12].m_v;
        world.info().m_gravity.setY(spoilt);
        for (int i = 0; i < 5; ++i) {
            world.step(1.0 / 60.0);
            EXPECT_FALSE(isFinite(world.info().m_gravity)) << "it is the user's";
        }
        expect_told("gravity is not finite", "counts as 0");
        EXPECT_NEAR(healthy->m_nodes[12].m_v.y(), before.y(), 0.4);
        world.info().m_gravity = {0, -9.81f, 0};
        world.step(1.0 / 60.0, 6);
        EXPECT_LT(healthy->m_nodes[12].m_v.y(), before.y() - 0.5f);
    }
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST_F(BadInput, FrictionThatIsNoneOrInfiniteFailsNoStep) {
    constexpr btScalar infinite = std::numeric_limits<btScalar>::infinity();
    btRigidBody* floor = world.add(new btBoxShape({2, 0.5f, 2}), {0, -0.6f, 0});
    btSoftBody* body = world.add(patch(world.info(), {0, 0, 0}, 9));
    for (int i = 0; i < 40; ++i) {
        const btScalar values[] = {kNan, infinite, -1, 0.5f, -infinite};
        floor->setFriction(values[i % 5]);
        body->m_cfg.kDF = values[i / 5 % 5];
        world.step(1.0 / 60.0);
    }
    EXPECT_EQ(solver.status().clothBodies, 2);
    EXPECT_EQ(solver.status().failedSteps, 0);
    EXPECT_GT(node(*body, 40).y(), -0.12);
}

TEST_F(BadInput, AnEdgeOfThreeFacesIsTold) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->appendNode({0, 0.3f, 0}, 1);
    body->appendFace(0, 1, 25);
    body->appendFace(1, 0, 24);
    run(body);
    expect_told("edge 0-1", "more than two faces");
}

TEST_F(BadInput, DuplicateFacesAreTold) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    const auto nodes = body->m_faces[3].m_n;
    const auto index = [&](int c) { return static_cast<int>(nodes[c] - &body->m_nodes[0]); };
    const int a = index(0), b = index(1), c = index(2);
    body->appendFace(b, c, a);
    run(body);
    expect_told("faces 3 and 32", "join the same nodes");
}

TEST_F(BadInput, ANodeWithoutFacesIsTold) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->appendNode({0, 1, 0}, 1);
    run(body);
    expect_told("25", "belongs to no face");
}

TEST_F(BadInput, AFaceWithoutAreaIsTold) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->m_nodes[1].m_x = body->m_nodes[0].m_x;
    run(body);
    expect_told("face", "area");
}

TEST_F(BadInput, AFaceThatNamesANodeTwiceIsLeftOutByBullet) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->appendFace(0, 0, 1);
    run(body);
    expect_cloth();
}

TEST_F(BadInput, NoFacesIsBulletsOwnBusiness) {
    run(btSoftBodyHelpers::CreateRope(world.info(), {0, 0, 0}, {1, 0, 0}, 8, 0));
    EXPECT_EQ(messages(), "");
    EXPECT_EQ(solver.status().bulletBodies, 1);
}

TEST_F(BadInput, NoMassAtAllIsClothOfPins) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    for (int i = 0; i < body->m_nodes.size(); ++i) body->setMass(i, 0);
    run(body);
    expect_cloth();
    EXPECT_EQ(node(*body, 12).y(), 0.0);
}

TEST_F(BadInput, ATotalMassOfZeroIsInfiniteInBulletAndFreezesTheBody) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->setTotalMass(0);
    run(body);
    expect_told("node 0", "inverse mass");
    EXPECT_EQ(solver.status().frozenBodies, 1);
    EXPECT_EQ(node(*body, 12).y(), 0.0);
}

TEST_F(BadInput, ANegativeInverseMassIsTold) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->m_nodes[4].m_im = -1;
    body->setUserIndex(7);
    world.add(body);
    world.step(1.0 / 60.0);
    expect_told("node 4", "inverse mass");
}

TEST_F(BadInput, PositionsFarFromTheOriginAreCloth) {
    btSoftBody* body = patch(world.info(), {1000, 0, 0});
    run(body);
    expect_cloth();
    EXPECT_LT(node(*body, 12).y(), -0.8);
}

TEST_F(BadInput, AnUnsupportedObstacleIsToldAndPassedThrough) {
    world.add(new btEmptyShape, {0, -0.2f, 0});
    btUniformScalingShape* scaled = new btUniformScalingShape(new btSphereShape(0.3f), 0.5f);
    world.add(scaled, {0, -0.4f, 0});
    run(patch(world.info(), {0, 0, 0}, 9));
    expect_cloth();
    delete scaled->getChildShape();
}

TEST_F(BadInput, NaNUnderBulletsStepDoesNotCrashItsDistanceField) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->appendNode({0, 0.1f, 0}, 1);  // belongs to no face: Bullet steps the body
    world.add(body);
    world.add(new btSphereShape(0.3f), {0, -0.2f, 0});
    world.step(1.0 / 60.0);
    body->addForce({kNan, 0, 0});
    world.step(1.0 / 60.0, 40);
    EXPECT_EQ(solver.status().frozenBodies, 1);
    EXPECT_LT(node(*healthy, 12).y(), -1.0);
}

// Bullet's broadphase loses objects beside one whose bounds are not finite.
TEST_F(BadInput, NaNInOneBodyHidesNoObstacleFromOthers) {
    world.add(new btBoxShape({2, 0.5f, 2}), {5, -1, 0});
    const btVector3 x[] = {{kNan, 0, 0}, {1, 0, kNan}, {0, kNan, 1}};
    const btScalar masses[] = {1, 1, 1};
    auto* broken = new btSoftBody(&world.info(), 3, x, masses);
    broken->appendFace(0, 1, 2);
    world.add(broken);
    world.step(1.0 / 60.0, 60);
    EXPECT_EQ(solver.status().frozenBodies, 1);
    EXPECT_GT(node(*healthy, 12).y(), -0.5);
}

TEST_F(BadInput, NaNIsPutBackInAPausedBodyToo) {
    btSoftBody* body = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0);
    const Vec3 before = node(*body, 3);
    body->m_cfg.timescale = 0;
    body->m_nodes[3].m_x.setX(kNan);
    world.step(1.0 / 60.0);
    EXPECT_EQ(node(*body, 3), before);
}

TEST_F(BadInput, ALongStepOrAFastTimeScaleCostsNoMoreThanTwoSeconds) {
    btGnnSoftBodySolver ticking(free_fall(nullptr, 1.0 / 30.0));
    World other(&ticking);
    btSoftBody* body = other.add(patch(other.info(), {0, 0, 0}));
    for (const btScalar scale : {1.0f, 1e6f, std::numeric_limits<float>::infinity()}) {
        const long before = ticking.status().steps;
        body->m_cfg.timescale = scale;
        other.step(1e4);
        EXPECT_LE(ticking.status().steps - before, 61) << scale;
    }
    EXPECT_TRUE(node(*body, 12).allFinite());
}

TEST_F(BadInput, DampingAboveOneStopsTheCloth) {
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->m_cfg.kDP = 1.5f;
    run(body);
    EXPECT_GT(node(*body, 12).y(), -0.3);
}

TEST_F(BadInput, ScalingToNothingIsToldAndLeavesTheBodyToBullet) {
    btSoftBody* body = world.add(patch(world.info(), {0, 0, 0}));
    body->setUserIndex(7);
    world.step(1.0 / 60.0);
    body->setRestLengthScale(0);
    world.step(1.0 / 60.0);
    expect_told("face", "area");
}

TEST_F(BadInput, MassesThatBecomeInfiniteFreezeTheBodyUntilTheyAreMended) {
    btSoftBody* body = world.add(patch(world.info(), {0, 0, 0}, 5, 1 + 2));
    body->setUserIndex(7);
    world.step(1.0 / 60.0, 20);
    const Points rest = solver.garmentOf(body)->rest().vertices;
    body->setTotalMass(0);
    const Vec3 before = node(*body, 24);
    world.step(1.0 / 60.0, 5);
    expect_told("node 0", "inverse mass");
    EXPECT_EQ(solver.status().frozenBodies, 1);
    EXPECT_EQ(node(*body, 24), before);
    for (int i = 0; i < body->m_nodes.size(); ++i) body->setMass(i, 1);
    world.step(1.0 / 60.0);
    ASSERT_NE(solver.garmentOf(body), nullptr);
    EXPECT_EQ(solver.garmentOf(body)->rest().vertices, rest);
    EXPECT_LT(node(*body, 24).y(), before.y());
}

TEST_F(BadInput, TrianglesThatShareAnEdgeByThreesHoldClothAndLooseBodies) {
    btTriangleMesh triangles;
    const btVector3 a(-1, -0.2f, 0), b(1, -0.2f, 0);
    for (const btVector3& c :
         {btVector3(0, -0.2f, 1), btVector3(0, -0.2f, -1), btVector3(0, -1, 0)})
        triangles.addTriangle(a, b, c);
    triangles.addTriangle(a, a, b);
    world.add(new btBvhTriangleMeshShape(&triangles, true), {0, 0, 0});
    world.add(new btSphereShape(0.1f), {0, 0.2f, 0}, false, 0.1f);
    run(patch(world.info(), {0, 0, 0}, 9));
    EXPECT_EQ(solver.status().clothBodies, 2);
    // The ball presses cloth on a surface of which inside and outside cannot be told.
    for (const btGnnSolverMessage& message : solver.status().messages)
        EXPECT_NE(message.text.find("energy in a step, which was taken away"), std::string::npos)
            << message.text;
}

TEST_F(BadInput, ContactWithOtherSoftBodiesIsToldWhereBothAskForIt) {
    btSoftBody* above = world.add(patch(world.info(), {0, 2, 0}, 9));
    btSoftBody* below = world.add(patch(world.info(), {0, 1, 0}, 9));
    for (int i = 0; i < 9; ++i) below->setMass(i, 0);
    below->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    world.step(1.0 / 60.0, 60);
    EXPECT_EQ(messages(), "");  // Bullet's own would not collide either
    EXPECT_LT(node(*above, 40).y(), 0.0);

    solver.detach(below);  // cloth would be caught by cloth
    btSoftBody* second = patch(world.info(), {0, 2, 0}, 9);
    second->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    world.add(second);
    world.step(1.0 / 60.0, 5);
    EXPECT_EQ(messages(), "");  // too far away
    world.step(1.0 / 60.0, 55);
    ASSERT_EQ(solver.status().messages.size(), 1u) << messages();
    for (const char* part : {"it meets soft body", "VF_SS", "Remedy: "})
        EXPECT_NE(messages().find(part), std::string::npos) << part << " in: " << messages();
    EXPECT_LT(node(*second, 40).y(), 0.0);
}

TEST_F(BadInput, AnObstacleWhosePoseIsNotFiniteIsNone) {
    btRigidBody* box = world.add(new btBoxShape({0.3f, 0.1f, 0.3f}), {0, -0.2f, 0}, true);
    btSoftBody* body = patch(world.info(), {0, 0, 0});
    body->appendAnchor(0, box);
    world.add(body);
    world.step(1.0 / 60.0, 5);
    const Vec3 anchored = node(*body, 0);
    btTransform nowhere = box->getWorldTransform();
    nowhere.setOrigin({kNan, 0, 0});
    box->setWorldTransform(nowhere);
    world.step(1.0 / 60.0, 30);
    expect_cloth();
    EXPECT_EQ(node(*body, 0), anchored);
}

}  // namespace cloth::bad_input_test
