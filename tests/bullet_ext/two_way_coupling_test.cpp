// What dynamic rigid bodies feel of the cloth, checked by the balance of momentum.

#include <gtest/gtest.h>

#include <cmath>

#include "bullet_ext/softBodyGarment.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"

namespace cloth::two_way_coupling_test {

using namespace cloth::test;

namespace {

/// In the masses that the cloth moves with.
Vec3 momentum(const btSoftBody& cloth, const btGnnSoftBodySolver& solver) {
    const Garment& garment = *solver.garmentOf(&cloth);
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < cloth.m_nodes.size(); ++i)
        if (cloth.m_nodes[i].m_im > 0) sum += garment.masses()[i] * toVec3(cloth.m_nodes[i].m_v);
    return massRatio(cloth, garment) * sum;
}

Vec3 momentum(const btRigidBody& body) {
    return toVec3(body.getLinearVelocity()) / static_cast<double>(body.getInvMass());
}

struct Case {
    double fixed_dt, rate;
};
constexpr Case kCases[] = {{0.0, 60.0}, {1.0 / 30.0, 60.0}, {1.0 / 30.0, 240.0}};

void weightless(World& world) {
    world->setGravity({0, 0, 0});
    world.info().m_gravity.setZero();
}

}  // namespace

TEST(TwoWayCoupling, ABoxThatDragsClothIsSlowedByIt) {
    for (const Case& c : kCases) {
        btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt), soft_cotton());
        World world(&solver);
        weightless(world);
        btRigidBody* box =
            world.add(new btBoxShape({0.1f, 0.1f, 0.5f}), {-0.6f, 0, 0}, false, 0.5f);
        box->setLinearVelocity({-1, 0, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 7));
        cloth->setTotalMass(0.4f);
        for (int k = 0; k < 7; ++k) cloth->appendAnchor(7 * k, box, true);
        for (int i = 0; i < static_cast<int>(4 * c.rate); ++i) world.step(1.0 / c.rate);
        const Vec3 total = momentum(*cloth, solver) + momentum(*box);
        EXPECT_LT((total - Vec3(-0.5, 0, 0)).norm(), 1e-4) << c.fixed_dt << " " << c.rate;
        // In the end they fly together: 0.5 kg m/s over 0.9 kg.
        EXPECT_NEAR(box->getLinearVelocity().x(), -0.5 / 0.9, 0.1);
    }
}

TEST(TwoWayCoupling, ABallThatHitsClothGivesItWhatItLoses) {
    for (const Case& c : kCases) {
        btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt), soft_cotton());
        World world(&solver);
        weightless(world);
        btRigidBody* ball = world.add(new btSphereShape(0.15f), {0, -0.25f, 0}, false, 0.3f);
        ball->setLinearVelocity({0, 1.5f, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 13));
        cloth->setTotalMass(0.2f);
        for (int i = 0; i < static_cast<int>(c.rate); ++i) world.step(1.0 / c.rate);
        const Vec3 total = momentum(*cloth, solver) + momentum(*ball);
        EXPECT_LT((total - Vec3(0, 0.45, 0)).norm(), 1e-4) << c.fixed_dt << " " << c.rate;
        EXPECT_LT(ball->getLinearVelocity().y(), 1.3) << c.fixed_dt << " " << c.rate;
        EXPECT_GT(momentum(*cloth, solver).y(), 0.06) << c.fixed_dt << " " << c.rate;
    }
}

TEST(TwoWayCoupling, WhatTheStepperDidNotSolveCostsNoMomentum) {
    for (const Case& c : kCases) {
        btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt, 1), soft_cotton());
        World world(&solver);
        weightless(world);
        btRigidBody* ball = world.add(new btSphereShape(0.15f), {0.3f, -0.25f, 0.3f}, false, 0.1f);
        ball->setLinearVelocity({0, 3, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 13));
        cloth->setTotalMass(0.2f);
        for (int i = 0; i < static_cast<int>(c.rate); ++i) world.step(1.0 / c.rate);
        const Vec3 total = momentum(*cloth, solver) + momentum(*ball);
        EXPECT_LT((total - Vec3(0, 0.3, 0)).norm(), 1e-4) << c.fixed_dt << " " << c.rate;
        EXPECT_LT(ball->getLinearVelocity().y(), 2.0f) << c.fixed_dt << " " << c.rate;
    }
}

// Steps of 1/30 s let it dance for long: one start says little.
TEST(TwoWayCoupling, ABallLiesInAHammock) {
    constexpr int kStarts = 4;
    for (const Case& c : kCases) {
        double weight = 0.0;
        int counted = 0;
        for (int start = 0; start < kStarts; ++start) {
            btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt), soft_cotton());
            World world(&solver);
            const btScalar aside = 1e-4f * static_cast<btScalar>(start);
            btRigidBody* ball = world.add(new btSphereShape(0.15f), {aside, 0.2f, 0}, false, 0.1f);
            ball->setActivationState(DISABLE_DEACTIVATION);
            btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 11, 1 + 2 + 4 + 8));
            cloth->setMass(60, cloth->getMass(60));
            cloth->m_cfg.kDP = static_cast<btScalar>(1.0 - std::pow(0.1, 1.0 / c.rate));
            // The fabric's own weight, so that its stiffness is what it is for real cloth.
            for (int i = 0; i < cloth->m_nodes.size(); ++i)
                if (cloth->m_nodes[i].m_im > 0) cloth->m_nodes[i].m_im = 121.0f / 0.2f;
            for (int i = 0; i < static_cast<int>(5 * c.rate); ++i) {
                const Vec3 before = momentum(*ball);
                world.step(1.0 / c.rate);
                if (i < static_cast<int>(3 * c.rate)) continue;
                // Gravity acts first and the cloth last.
                weight += (momentum(*ball).y() - before.y()) * c.rate + 0.1 * 9.81;
                ++counted;
            }
            EXPECT_GT(ball->getWorldTransform().getOrigin().y(), -1.0)
                << c.fixed_dt << " " << c.rate << " " << start;
        }
        EXPECT_NEAR(weight / counted, 0.1 * 9.81, 0.05) << c.fixed_dt << " " << c.rate;
    }
}

TEST(TwoWayCoupling, ALightBoxOnHeavyClothDoesNotRunAway) {
    for (const Case& c : kCases) {
        btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt, 8), soft_cotton());
        World world(&solver);
        btRigidBody* box =
            world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {-0.5f, 0, -0.6f}, false, 0.5f);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 7, 4 + 8));
        cloth->setTotalMass(10);
        cloth->appendAnchor(0, box);
        cloth->appendAnchor(6, box);
        double fastest = 0.0;
        for (int i = 0; i < static_cast<int>(4 * c.rate); ++i) {
            world.step(1.0 / c.rate);
            fastest = std::max(fastest, static_cast<double>(box->getLinearVelocity().length()));
        }
        EXPECT_LT(fastest, 8.0) << c.fixed_dt << " " << c.rate;
        EXPECT_LT(box->getLinearVelocity().length(), 6.0f) << c.fixed_dt << " " << c.rate;
    }
}

// Its internal forces are unknown: better no reaction than a wrong one.
TEST(TwoWayCoupling, ABoxAnchoredToXpbdClothFeelsNothingOfIt) {
    btGnnSoftBodySolver solver(
        [](const Garment& garment) { return std::make_unique<XpbdStepper>(garment); });
    World world(&solver);
    btRigidBody* box = world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {-0.5f, 0, -0.6f}, false, 1);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 7));
    cloth->appendAnchor(0, box, true);
    cloth->appendAnchor(6, box, true);
    world.step(1.0 / 60.0, 60);
    EXPECT_NEAR(box->getLinearVelocity().y(), -9.81, 0.01);
    EXPECT_LT(node(*cloth, 24).y(), -1.0);
}

TEST(TwoWayCoupling, ThatXpbdIsNotBalancedIsToldWhereABodyLandsOnIt) {
    btGnnSoftBodySolver solver(
        [](const Garment& garment) { return std::make_unique<XpbdStepper>(garment); });
    World world(&solver);
    world.add(new btSphereShape(0.15f), {0, 0.25f, 0}, false, 0.1f);
    world.add(patch(world.info(), {0, 0, 0}, 11, 1 + 2 + 4 + 8));
    world.step(1.0 / 60.0);
    EXPECT_TRUE(solver.status().messages.empty()) << "it is in the air";
    world.step(1.0 / 60.0, 30);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    EXPECT_NE(solver.status().messages[0].text.find("does not know its energy"), std::string::npos);
}

// The middle of the patch and a corner, which weighs a fraction of the middle.
TEST(TwoWayCoupling, AWeakAnchorPullsBothEnds) {
    for (const Case& c : kCases)
        for (const int anchored : {12, 0}) {
            SCOPED_TRACE(std::to_string(c.fixed_dt) + " " + std::to_string(c.rate) + " node " +
                         std::to_string(anchored));
            btGnnSoftBodySolver solver(quasi_newton(c.fixed_dt), soft_cotton());
            World world(&solver);
            weightless(world);
            btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5));
            cloth->setTotalMass(0.5f);
            btRigidBody* box =
                world.add(new btBoxShape({0.1f, 0.1f, 0.1f}),
                          cloth->m_nodes[anchored].m_x + btVector3(0, 0.3f, 0), false, 1);
            box->setLinearVelocity({0, 0.5f, 0});
            cloth->appendAnchor(anchored, box, true, 0.3f);
            for (int i = 0; i < static_cast<int>(c.rate); ++i) world.step(1.0 / c.rate);
            EXPECT_TRUE(solver.garmentOf(cloth)->pins().empty());
            const Vec3 total = momentum(*cloth, solver) + momentum(*box);
            EXPECT_LT((total - Vec3(0, 0.5, 0)).norm(), 2e-3);
            EXPECT_LT(box->getLinearVelocity().y(), 0.47f);
            const Vec3 anchor = toVec3(box->getWorldTransform() * cloth->m_anchors[0].m_local);
            EXPECT_LT((node(*cloth, anchored) - anchor).norm(), 0.1);
        }
}

TEST(TwoWayCoupling, BodiesThatLeaveTheWorldAreForgotten) {
    btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0), soft_cotton());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 7));
    auto shape = std::make_unique<btSphereShape>(0.2f);
    auto ball = std::make_unique<btRigidBody>(0.01f, nullptr, shape.get(), btVector3(1, 1, 1));
    ball->setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, -0.21f, 0}));
    world->addRigidBody(ball.get());
    world.step(1.0 / 60.0, 6);
    world->removeRigidBody(ball.get());
    ball.reset();
    world.step(1.0 / 60.0, 6);
    EXPECT_TRUE(std::isfinite(node(*cloth, 24).y()));
    EXPECT_EQ(solver.status().failedSteps, 0);
}

}  // namespace cloth::two_way_coupling_test
