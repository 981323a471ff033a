// kDF means to our cloth what it means to Bullet's; or Coulomb's coefficient, if that is asked for.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bullet_ext/softBodyGarment.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/sanitized.h"

namespace cloth::sliding_friction_test {

using namespace cloth::test;

namespace {

StepperFactory stepper() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

btGnnSolverSettings coulomb() {
    btGnnSolverSettings settings;
    settings.friction = btGnnFriction::coulomb;
    return settings;
}

/// How far a sheet that lies on the ground slides when it is pushed at `speed` (m).
double slide(btSoftBodySolver* solver, double speed, btScalar kDF, btScalar ground = 0.5f) {
    World world(solver);
    world.add(new btBoxShape({50, 1, 50}), {0, -1, 0})->setFriction(ground);
    btSoftBody* cloth = patch(world.info(), {0, 0.02f, 0}, 7);
    cloth->getCollisionShape()->setMargin(0.02f);
    cloth->m_cfg.kDF = kDF;
    world.add(cloth);
    world.step(1.0 / 60.0, 60);
    const double from = node(*cloth, 24).x();
    cloth->addVelocity({static_cast<btScalar>(speed), 0, 0});
    world.step(1.0 / 60.0, 360);
    return node(*cloth, 24).x() - from;
}

}  // namespace

TEST(SlidingFriction, APushedSheetSlidesAsFarAsBullets) {
    for (const double speed : {1.0, 2.0, 4.0})
        for (const btScalar kDF : {0.1f, 0.2f, 0.5f}) {
            btGnnSoftBodySolver solver(stepper());
            const double bullets = slide(nullptr, speed, kDF);
            EXPECT_NEAR(slide(&solver, speed, kDF), bullets, 0.04 + 0.1 * bullets)
                << speed << " m/s, kDF " << kDF;
        }
}

TEST(SlidingFriction, AStepperWithItsOwnTimeStepSlidesAsFar) {
    btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0));
    const double bullets = slide(nullptr, 2.0, 0.2f);
    EXPECT_NEAR(slide(&solver, 2.0, 0.2f), bullets, 0.2 * bullets);
}

// A corner that touches the ground first is stopped, the rest flies on: in a step of 1/30 s it
// would be a metre away from where it belongs.
TEST(SlidingFriction, AFastLandingInLongStepsDoesNotTearTheSheet) {
    btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0));
    World world(&solver);
    world.add(new btBoxShape({500, 1, 500}), {0, -1, 0})->setFriction(1);
    btSoftBody* cloth = patch(world.info(), {0, 3, 0}, 7);
    cloth->rotate(btQuaternion({0.6f, 0, 0.8f}, 0.3f));
    cloth->m_cfg.kDF = 1;
    world.add(cloth);
    cloth->setVelocity({20, -20, 0});
    double longest = 0.0;
    for (int i = 0; i < 120; ++i) {
        world.step(1.0 / 240.0, 1);
        for (int l = 0; l < cloth->m_links.size(); ++l) {
            const btSoftBody::Link& link = cloth->m_links[l];
            const double length = (link.m_n[0]->m_x - link.m_n[1]->m_x).length();
            longest = std::max(longest, length / static_cast<double>(link.m_rl));
        }
    }
    EXPECT_LT(longest, 1.3);
}

TEST(SlidingFriction, CoulombsIsExactIfItIsAsked) {
    for (const double speed : {1.0, 2.0}) {
        btGnnSoftBodySolver solver(stepper(), coulomb());
        const double expected = speed * speed / (2 * 0.2 * 0.5 * 9.81);
        EXPECT_NEAR(slide(&solver, speed, 0.2f), expected, 0.12 * expected) << speed;
    }
}

TEST(SlidingFriction, WithoutFrictionNothingIsHeld) {
    btGnnSoftBodySolver solver(stepper());
    EXPECT_NEAR(slide(&solver, 1.0, 0.0f), 6.0, 0.1);
}

// Bullet's sheet stays on the capsule, as in its demo of that name, for as long as one looks.
TEST(SlidingFriction, ASheetStaysOnACapsule) {
    for (const bool ours : {false, true}) {
        btGnnSoftBodySolver solver(stepper());
        World world(ours ? &solver : nullptr);
        auto* capsule = new btCapsuleShapeX(1, 5);
        capsule->setMargin(0.5f);
        world.add(capsule, {0, 4, 0})->setFriction(0.8f);
        btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.info(), {-4, 6, -4}, {4, 6, -4},
                                                           {-4, 6, 4}, {4, 6, 4}, 20, 20, 0, true);
        cloth->setTotalMass(0.1f);
        cloth->m_cfg.piterations = 10;
        world.add(cloth);
        world.step(1.0 / 60.0, fewer_if_sanitized(60 * 30));
        double middle = 0.0, highest = -1e3;
        for (int i = 0; i < 400; ++i) {
            middle += node(*cloth, i).z() / 400;
            highest = std::max(highest, node(*cloth, i).y());
        }
        EXPECT_GT(highest, 4.9) << ours;
        EXPECT_LT(std::abs(middle), 0.3) << ours;
    }
}

// A sheet on a light, free slab in space: both go on together, with the momentum there was.
TEST(SlidingFriction, ADynamicBodyGetsWhatTheClothLoses) {
    for (const double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(quasi_newton(fixed));
        World world(&solver);
        world->setGravity({0, 0, 0});
        world.info().m_gravity.setZero();
        btRigidBody* slab = world.add(new btBoxShape({2, 0.1f, 2}), {0, -0.1f, 0}, false, 0.05f);
        slab->setFriction(1);
        btSoftBody* cloth = patch(world.info(), {0, 0.004f, 0}, 7);
        cloth->setTotalMass(0.5f, true);
        cloth->m_cfg.kDF = 0.5f;
        world.add(cloth);
        world.step(1.0 / 60.0);
        cloth->addVelocity({1, 0, 0});
        const double before = 0.5 * static_cast<double>(cloth->m_nodes[24].m_v.x()) +
                              0.05 * static_cast<double>(slab->getLinearVelocity().x());
        double fastest = 0.0;
        for (int i = 0; i < 60; ++i) {
            world.step(1.0 / 60.0);
            fastest = std::max(fastest, static_cast<double>(slab->getLinearVelocity().x()));
        }
        const Garment& garment = *solver.garmentOf(cloth);
        double after = 0.05 * static_cast<double>(slab->getLinearVelocity().x());
        for (int i = 0; i < 49; ++i)
            after += massRatio(*cloth, garment) * garment.masses()[i] *
                     static_cast<double>(cloth->m_nodes[i].m_v.x());
        EXPECT_NEAR(after, before, 2e-3) << fixed;
        EXPECT_GT(fastest, 0.5) << fixed;
        EXPECT_LT(fastest, 1.01) << fixed;
    }
}

}  // namespace cloth::sliding_friction_test
