// What a program may do to cloth in mid-run: masses, links, cuts, and handing it over to Bullet.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bullet_ext/softBodyGarment.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::run_time_changes_test {

using namespace cloth::test;

namespace {

StepperFactory stepper() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

btGnnSolverSettings of_soft_cotton() {
    btGnnSolverSettings settings;
    settings.fabric = Fabric::soft_cotton();
    return settings;
}

double fastest(const btSoftBody& body) {
    double speed = 0.0;
    for (int i = 0; i < body.m_nodes.size(); ++i)
        speed = std::max(speed, static_cast<double>(body.m_nodes[i].m_v.length()));
    return speed;
}

/// A sheet of soft cotton that hangs by two corners and stretches under its weight.
class StretchedSheet : public testing::Test {
 protected:
    StretchedSheet() : solver(stepper(), of_soft_cotton()), world(&solver) {
        cloth = world.add(btSoftBodyHelpers::CreatePatch(
            world.info(), {-1, 0, -1}, {1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, 11, 11, 1 + 2, true));
        cloth->m_cfg.kDP = 0.03f;
        world.step(1.0 / 60.0, 240);
        lengths = restLengths(*cloth);
    }

    double stretch() const {
        const std::vector<double> now = lengthsAt(*cloth, nodePositions(*cloth));
        double most = 0.0;
        for (size_t i = 0; i < now.size(); ++i) most = std::max(most, now[i] / lengths[i]);
        return most;
    }
    double area() const { return solver.garmentOf(cloth)->face_areas().sum(); }
    /// Cuts a disc out of its middle; nodes are added.
    void cut() {
        struct Ball : btSoftBody::ImplicitFn {
            btVector3 centre;
            btScalar Eval(const btVector3& x) override {
                return (x - centre).length() - btScalar(0.3);
            }
        } ball;
        ball.centre = cloth->m_nodes[60].m_x;
        const int nodes = cloth->m_nodes.size();
        cloth->refine(&ball, 1e-4f, /*cut=*/true);
        ASSERT_GT(cloth->m_nodes.size(), nodes);
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth = nullptr;
    std::vector<double> lengths;
};

/// A sheet that lies on a ball.
class SheetOnABall : public testing::Test {
 protected:
    SheetOnABall() : solver(stepper()), world(&solver) {
        world.add(new btSphereShape(0.3f), {0, 0, 0})->setFriction(1);
        cloth = patch(world.info(), {0, 0.31f, 0}, 13);
        cloth->m_cfg.kDP = 0.05f;
        cloth->m_cfg.kDF = 1;
        cloth->m_cfg.piterations = 5;
        world.add(cloth);
        world.step(1.0 / 60.0, 180);
    }

    /// The fastest node in the next seconds, and the highest.
    void expect_calm(const char* what) {
        double speed = 0.0, height = 0.0;
        for (int i = 0; i < 300; ++i) {
            world.step(1.0 / 60.0);
            speed = std::max(speed, fastest(*cloth));
            for (int k = 0; k < cloth->m_nodes.size(); ++k)
                height = std::max(height, node(*cloth, k).y());
        }
        EXPECT_EQ(solver.status().bulletBodies, 1) << what;
        EXPECT_LT(height, 0.8) << what;
        EXPECT_LT(speed, 5.0) << what;
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth = nullptr;
};

}  // namespace

TEST_F(StretchedSheet, MassesDoNotChangeItsRestShape) {
    ASSERT_GT(stretch(), 1.1);
    cloth->setMass(60, 3);
    world.step(1.0 / 60.0, 2);
    EXPECT_NEAR(area(), 4.0, 1e-4);
    cloth->setTotalMass(7);
    world.step(1.0 / 60.0, 2);
    EXPECT_NEAR(area(), 4.0, 1e-4);
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST_F(StretchedSheet, BendingLinksDoNotChangeItsRestShape) {
    cloth->generateBendingConstraints(2, cloth->appendMaterial());
    world.step(1.0 / 60.0, 2);
    EXPECT_NEAR(area(), 4.0, 1e-4);
}

TEST_F(StretchedSheet, ScalingDoes) {
    cloth->scale({1.5f, 1.5f, 1.5f});
    world.step(1.0 / 60.0);
    EXPECT_NEAR(area(), 2.25 * 4.0, 1e-2);
    cloth->setRestLengthScale(0.8f);
    world.step(1.0 / 60.0);
    EXPECT_NEAR(area(), 0.64 * 2.25 * 4.0, 1e-2);
}

TEST_F(StretchedSheet, ScalingAfterMassesDoesToo) {
    cloth->setTotalMass(7);
    world.step(1.0 / 60.0, 30);
    cloth->scale({1.5f, 1.5f, 1.5f});
    cloth->setTotalMass(9);
    world.step(1.0 / 60.0);
    EXPECT_NEAR(area(), 2.25 * 4.0, 1e-2);
}

TEST_F(StretchedSheet, ACutKeepsItsRestAreaAndFabric) {
    solver.attach(cloth, *solver.garmentOf(cloth));
    ASSERT_GT(stretch(), 1.1);
    const double before = area();
    cut();
    world.step(1.0 / 60.0);
    EXPECT_NEAR(area(), before, 1e-3);
    EXPECT_EQ(solver.garmentOf(cloth)->fabric().mu, Fabric::soft_cotton().mu);
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60.0);
        ASSERT_LT(fastest(*cloth), 10.0);
    }
    EXPECT_EQ(solver.status().failedSteps, 0);
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST_F(StretchedSheet, ACutAndATeleportInOneFrameKeepItsRestArea) {
    const double before = area();
    cut();
    solver.teleport(cloth, btTransform(btQuaternion({0, 1, 0}, 1), {5, 1, 0}));
    EXPECT_NEAR(area(), before, 1e-3);
    world.step(1.0 / 60.0);
    EXPECT_NEAR(area(), before, 1e-3);
    EXPECT_LT(fastest(*cloth), 10.0);
    EXPECT_EQ(solver.status().failedSteps, 0);
    EXPECT_TRUE(solver.status().messages.empty());
}

// As a game does that goes back to a saved moment, or repeats frames.
TEST_F(SheetOnABall, AttachedAnewItForgetsWhatCameBetween) {
    btRigidBody* pusher = world.add(new btSphereShape(0.1f), {0.6f, 0.3f, 0}, true);
    const auto run = [&](float way) {
        for (int i = 0; i < 20; ++i) {
            const btScalar x = 0.6f - way * static_cast<float>(i) / 20;
            pusher->setWorldTransform(btTransform(btQuaternion::getIdentity(), {x, 0.3f, 0}));
            world.step(1.0 / 60.0);
        }
        return nodePositions(*cloth);
    };
    run(0.2f);
    std::vector<btVector3> places, velocities;
    for (int i = 0; i < cloth->m_nodes.size(); ++i) {
        places.push_back(cloth->m_nodes[i].m_x);
        velocities.push_back(cloth->m_nodes[i].m_v);
    }
    const auto go_back = [&] {
        pusher->setWorldTransform(btTransform(btQuaternion::getIdentity(), {0.6f, 0.3f, 0}));
        world.step(1.0 / 60.0, 2);  // the pusher stands there
        for (int i = 0; i < cloth->m_nodes.size(); ++i) {
            btSoftBody::Node& node = cloth->m_nodes[i];
            node.m_x = node.m_q = places[static_cast<size_t>(i)];
            node.m_v = velocities[static_cast<size_t>(i)];
        }
        solver.attach(cloth, Garment(*solver.garmentOf(cloth)));
    };
    go_back();
    const Points first = run(0.5f);
    go_back();
    EXPECT_EQ(run(0.5f), first);
    go_back();
    EXPECT_NE(run(0.3f), first);
    go_back();
    EXPECT_EQ(run(0.5f), first);
}

TEST_F(SheetOnABall, ItIsHandedOverWithoutAKick) {
    const btScalar margin = cloth->getCollisionShape()->getMargin();
    solver.detach(cloth);
    expect_calm("detach()");
    EXPECT_EQ(cloth->getCollisionShape()->getMargin(), margin);
}

TEST_F(SheetOnABall, ClustersHandItOverWithoutAKick) {
    cloth->generateClusters(8);
    expect_calm("generateClusters()");
}

TEST_F(SheetOnABall, ComingBackToUsItHasItsMarginAgain) {
    const btScalar margin = cloth->getCollisionShape()->getMargin();
    solver.detach(cloth);
    world.step(1.0 / 60.0, 3);
    EXPECT_LT(cloth->getCollisionShape()->getMargin(), margin);
    solver.attach(cloth);
    EXPECT_EQ(cloth->getCollisionShape()->getMargin(), margin);
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(solver.status().clothBodies, 1);
}

// As with Bullet's solver: without a kind of collision with rigid bodies there is none.
TEST(RunTimeChanges, ClothWithoutCollisionFlagsFallsThrough) {
    btGnnSoftBodySolver solver(stepper());
    World world(&solver);
    world.add(new btBoxShape({5, 0.5f, 5}), {0, -0.5f, 0});
    btSoftBody* cloth = patch(world.info(), {0, 0.1f, 0}, 5);
    cloth->m_cfg.collisions = 0;
    world.add(cloth);
    world.step(1.0 / 60.0, 60);
    EXPECT_LT(node(*cloth, 12).y(), -1.0);
    cloth->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    cloth->translate(btVector3(0, 0.1f, 0) - cloth->m_nodes[12].m_x);
    cloth->setVelocity({0, 0, 0});
    world.step(1.0 / 60.0, 60);
    EXPECT_GT(node(*cloth, 12).y(), -1e-3);
}

// A ball and a box as Bullet's demos make them: links and bending links hold them up.
TEST(RunTimeChanges, ClosedSurfacesAreLeftToBulletUntilTheyAreAttached) {
    btGnnSoftBodySolver solver(stepper());
    World world(&solver);
    world.add(new btBoxShape({5, 0.5f, 5}), {0, -0.5f, 0});
    btSoftBody* ball =
        btSoftBodyHelpers::CreateEllipsoid(world.info(), {0, 1, 0}, {0.5f, 0.5f, 0.5f}, 64);
    ball->generateBendingConstraints(2);
    world.add(ball);
    world.step(1.0 / 60.0, 120);
    EXPECT_EQ(solver.status().bulletBodies, 1);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    EXPECT_EQ(solver.status().messages[0].count, 1);
    EXPECT_NE(solver.status().messages[0].text.find("its surface is closed"), std::string::npos);
    double low = 10.0, high = -10.0;
    for (int i = 0; i < ball->m_nodes.size(); ++i) {
        low = std::min(low, node(*ball, i).y());
        high = std::max(high, node(*ball, i).y());
    }
    EXPECT_GT(high - low, 0.6);
    solver.attach(ball);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().clothBodies, 1);
}

}  // namespace cloth::run_time_changes_test
