// Cloth that rests sleeps and costs nothing; whatever concerns it wakes it.

#include <gtest/gtest.h>

#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"

namespace cloth::cloth_sleep_test {

using namespace cloth::test;

namespace {

/// A sheet on a static box, stepped until it sleeps.
class SleepingSheet : public testing::Test {
 protected:
    SleepingSheet() : solver(quasi_newton(1.0 / 30.0, 5)), world(&solver) {
        table = world.add(new btBoxShape({1, 0.5f, 1}), {0, -0.5f, 0});
        cloth = world.add(patch(world.info(), {0, 0.01f, 0}, 9));
        cloth->setTotalMass(0.2f);
        for (int i = 0; i < 60 * 6 && !asleep(); ++i) world.step(1.0 / 60.0);
    }
    bool asleep() const { return solver.status().sleepingBodies == 1; }
    void expect_wakes(const char* why) {
        ASSERT_TRUE(asleep()) << why;
        const long before = solver.status().steps;
        world.step(1.0 / 60.0);
        EXPECT_FALSE(asleep()) << why;
        EXPECT_TRUE(cloth->isActive()) << why;
        world.step(1.0 / 60.0);  // cloth steps take two of the world's
        EXPECT_GT(solver.status().steps, before) << why;
    }

    btGnnSoftBodySolver solver;
    World world;
    btRigidBody* table;
    btSoftBody* cloth;
};

}  // namespace

TEST_F(SleepingSheet, CostsNoSteps) {
    ASSERT_TRUE(asleep());
    const long steps = solver.status().steps;
    const Vec3 place = node(*cloth, 40);
    world.step(1.0 / 60.0, 120);
    EXPECT_EQ(solver.status().steps, steps);
    EXPECT_EQ(node(*cloth, 40), place);
    EXPECT_EQ(solver.status().clothBodies, 1);
}

TEST_F(SleepingSheet, WakesWhenANodeIsPushed) {
    cloth->addVelocity({0, 1, 0});
    expect_wakes("velocity");
    EXPECT_GT(cloth->m_nodes[40].m_v.y(), 0.5f);
}

TEST_F(SleepingSheet, WakesByAForce) {
    cloth->addForce({0, 3, 0}, 40);
    expect_wakes("force");
}

TEST_F(SleepingSheet, WakesWhenItIsMoved) {
    cloth->translate({0, 1, 0});
    expect_wakes("translate");
    world.step(1.0 / 60.0, 12);
    EXPECT_LT(node(*cloth, 40).y(), 1.0);
}

TEST_F(SleepingSheet, WakesWhenItIsPinned) {
    cloth->setMass(0, 0);
    expect_wakes("pin");
}

TEST_F(SleepingSheet, WakesWhenItIsActivated) {
    cloth->activate();
    expect_wakes("activate");
}

TEST_F(SleepingSheet, WakesByWindAndGravity) {
    world.info().m_gravity = {0, 9.81f, 0};
    expect_wakes("gravity");
    world.step(1.0 / 60.0, 12);
    EXPECT_GT(node(*cloth, 40).y(), 0.1);
}

TEST_F(SleepingSheet, WakesWhenItsTableIsMovedOrTaken) {
    table->getWorldTransform().getOrigin() += btVector3(0, 0.01f, 0);
    world->updateAabbs();
    expect_wakes("moved");
    for (int i = 0; i < 60 * 6 && !asleep(); ++i) world.step(1.0 / 60.0);
    world->removeRigidBody(table);
    expect_wakes("taken");
    world.step(1.0 / 60.0, 30);
    EXPECT_LT(node(*cloth, 40).y(), -0.5);
    world->addRigidBody(table);
}

TEST_F(SleepingSheet, WakesWhenItsTableIsTakenForAnotherOfItsShape) {
    ASSERT_TRUE(asleep());
    world->removeRigidBody(table);
    world->addRigidBody(table);
    expect_wakes("another body");
}

TEST_F(SleepingSheet, WakesWhenAChildOfItsTableIsMoved) {
    btBoxShape post({0.1f, 0.1f, 0.1f}), top({0.8f, 0.05f, 0.8f});
    btCompoundShape compound;
    const auto at = [](const btVector3& place) {
        return btTransform(btQuaternion::getIdentity(), place);
    };
    compound.addChildShape(at({-4, 0, -4}), &post);
    compound.addChildShape(at({4, 0.5f, 4}), &post);
    compound.addChildShape(at({0, 0.45f, 0}), &top);
    table->setCollisionShape(&compound);
    for (int i = 0; i < 60 * 6; ++i) world.step(1.0 / 60.0);
    ASSERT_TRUE(asleep());
    compound.updateChildTransform(2, at({2.5f, 0.45f, 0}));
    expect_wakes("child");
    world.step(1.0 / 60.0, 30);
    EXPECT_LT(node(*cloth, 40).y(), -0.5);
    world.remove(table);
}

TEST_F(SleepingSheet, WakesWhenABallFallsOnIt) {
    ASSERT_TRUE(asleep());
    btRigidBody* ball = world.add(new btSphereShape(0.25f), {0, 0.8f, 0}, false, 0.5f);
    world.step(1.0 / 60.0, 60);
    EXPECT_FALSE(asleep());
    EXPECT_GT(ball->getWorldTransform().getOrigin().y(), 0.2);
    EXPECT_LT(ball->getWorldTransform().getOrigin().y(), 0.4);
}

TEST_F(SleepingSheet, SleepsTogetherWithTheBallOnIt) {
    btRigidBody* ball = world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {0, 0.12f, 0}, false, 0.2f);
    for (int i = 0; i < 60 * 12 && !(asleep() && !ball->isActive()); ++i) world.step(1.0 / 60.0);
    EXPECT_TRUE(asleep());
    EXPECT_FALSE(ball->isActive());
    const float height = ball->getWorldTransform().getOrigin().y();
    world.step(1.0 / 60.0, 60);
    EXPECT_EQ(ball->getWorldTransform().getOrigin().y(), height);
}

TEST(ClothSleep, HangingClothSleepsUnlessItMustNot) {
    for (const bool must_not : {false, true}) {
        btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0, 5), soft_cotton());
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 7, 1 + 2));
        cloth->m_cfg.kDP = 0.05f;
        if (must_not) cloth->setActivationState(DISABLE_DEACTIVATION);
        world.step(1.0 / 60.0, 60 * 15);
        EXPECT_EQ(solver.status().sleepingBodies, must_not ? 0 : 1);
    }
}

}  // namespace cloth::cloth_sleep_test
