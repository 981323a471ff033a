// Cloth that bodies close on: it has no room, and stays calm.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/metered_solver.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/sanitized.h"

namespace cloth::pinched_cloth_test {

using namespace cloth::test;

namespace {

btScalar real(int number) {
    return static_cast<btScalar>(number);
}

btSoftBody* sheet(World& world, btScalar half, btScalar y, int n, int pins = 0) {
    return btSoftBodyHelpers::CreatePatch(world.info(), {-half, y, -half}, {half, y, -half},
                                          {-half, y, half}, {half, y, half}, n, n, pins, true);
}

double highest(const btSoftBody& cloth) {
    double y = -1e9;
    for (int i = 0; i < cloth.m_nodes.size(); ++i) y = std::max(y, node(cloth, i).y());
    return y;
}

std::string messages(const btGnnSoftBodySolver& solver) {
    std::string all;
    for (const btGnnSolverMessage& message : solver.status().messages) all += message.text + "\n";
    return all;
}

btCollisionShape* ground(int kind) {
    if (kind == 0) return new btStaticPlaneShape({0, 1, 0}, 0);
    auto* slab = new btCompoundShape;
    static btBoxShape box({10, 0.5f, 10});
    slab->addChildShape(btTransform(btQuaternion::getIdentity(), {0, -0.5f, 0}), &box);
    return slab;
}

}  // namespace

TEST(PinchedCloth, ABoxThatLandsOnClothOnTheGroundStaysThere) {
    for (const int kind : {0, 1})
        for (const double fixed : {0.0, 1.0 / 30.0}) {
            SCOPED_TRACE(std::to_string(kind) + " " + std::to_string(fixed));
            btGnnSoftBodySolver solver(quasi_newton(fixed));
            World world(&solver);
            world.add(ground(kind), {0, 0, 0});
            btSoftBody* cloth = world.add(sheet(world, 1, 0.01f, 21));
            world.step(1.0 / 60.0, 60);
            btRigidBody* box =
                world.add(new btBoxShape({0.5f, 0.125f, 0.125f}), {0, 1.13f, 0}, false, 10);
            double speed = 0.0, top = 0.0;
            for (int i = 0; i < 90; ++i) {
                world.step(1.0 / 60.0);
                speed = std::max(speed, fastest_node(*cloth));
                top = std::max(top, highest(*cloth));
            }
            EXPECT_LT(speed, 1.0);
            EXPECT_LT(top, 0.1);
            EXPECT_NEAR(box->getWorldTransform().getOrigin().y(), 0.125, 0.01);
            EXPECT_LT(std::abs(box->getWorldTransform().getOrigin().x()), 0.05);
            EXPECT_LT(std::abs(box->getWorldTransform().getOrigin().z()), 0.05);
            EXPECT_LT(box->getLinearVelocity().length(), 0.05f);
        }
}

// Nodes lie inside the box, as far as it leaves no room for them: that is told as it is.
TEST(PinchedCloth, WhatIsShownInsideABodyIsMeasured) {
    for (const double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(quasi_newton(fixed));
        World world(&solver);
        world.add(new btBoxShape({10, 0.5f, 10}), {0, -0.5f, 0});
        btSoftBody* cloth = world.add(sheet(world, 0.5f, 0.005f, 9));
        btRigidBody* ball = world.add(new btSphereShape(0.2f), {0, 0.5f, 0}, false, 10);
        double deepest = 0.0;
        for (int i = 0; i < 60; ++i) {
            world.step(1.0 / 60.0);
            double depth = 0.0;
            for (int k = 0; k < cloth->m_nodes.size(); ++k) {
                const Vec3 x = node(*cloth, k);
                const Vec3 centre = toVec3(ball->getWorldTransform().getOrigin());
                depth = std::max({depth, -x.y(), 0.2 - (x - centre).norm()});
            }
            EXPECT_GE(solver.status().maxPenetration, depth - 1e-4) << fixed << " step " << i;
            deepest = std::max(deepest, depth);
        }
        EXPECT_GT(deepest, 2e-3) << fixed;
    }
}

// A kinematic box presses cloth onto a table and lifts again.
TEST(PinchedCloth, AKinematicBodyThatPressesClothOnATableDoesNotThrowIt) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    world.add(new btBoxShape({2, 0.5f, 2}), {0, -0.5f, 0});
    btSoftBody* cloth = world.add(sheet(world, 0.5f, 0.005f, 11));
    btRigidBody* hand = world.add(new btBoxShape({0.2f, 0.1f, 0.2f}), {0, 0.4f, 0}, true);
    double speed = 0.0;
    for (int i = 0; i < 90; ++i) {
        btTransform pose = hand->getWorldTransform();
        const double y = 0.05 + 0.35 * std::abs(i - 45) / 45.0;  // 5 cm into the table
        pose.setOrigin({0, static_cast<btScalar>(y), 0});
        hand->setWorldTransform(pose);
        world.step(1.0 / 60.0);
        speed = std::max(speed, fastest_node(*cloth));
    }
    EXPECT_LT(speed, 0.75);  // the hand's is 0.47
    EXPECT_LT(highest(*cloth), 0.1);
}

// A plate between two tables, with a sheet on either side of it: it cannot make room for both.
TEST(PinchedCloth, ClothThatFindsNoRoomIsToldAndStaysCalm) {
    constexpr int kNodes = 5;
    std::vector<btScalar> places;
    std::vector<int> corners;
    for (const btScalar y : {-0.003f, 0.003f}) {
        const int first = static_cast<int>(places.size()) / 3;
        for (int i = 0; i < kNodes * kNodes; ++i) {
            const btScalar x = real(i % kNodes), z = real(i / kNodes);
            places.insert(places.end(), {0.1f * x - 0.2f, y, 0.1f * z - 0.2f});
            if (i % kNodes == kNodes - 1 || i / kNodes == kNodes - 1) continue;
            const int a = first + i, b = a + 1, c = a + kNodes, d = c + 1;
            corners.insert(corners.end(), {a, c, b, b, c, d});
        }
    }
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* cloth = world.add(btSoftBodyHelpers::CreateFromTriMesh(
        world.info(), places.data(), corners.data(), static_cast<int>(corners.size()) / 3, false));
    world.add(new btBoxShape({2, 0.5f, 2}), {0, -0.505f, 0});
    world.add(new btBoxShape({2, 0.5f, 2}), {0, 0.505f, 0});
    btRigidBody* plate = world.add(new btBoxShape({0.15f, 0.001f, 0.15f}), {0, 0, 0}, true);
    double speed = 0.0;
    for (int i = 0; i < 30; ++i) {
        btTransform pose = plate->getWorldTransform();
        pose.setOrigin({0.002f * real(i), 0, 0});
        plate->setWorldTransform(pose);
        world.step(1.0 / 60.0);
        speed = std::max(speed, fastest_node(*cloth));
    }
    EXPECT_LT(speed, 0.5);
    EXPECT_NE(messages(solver).find("leave it no room"), std::string::npos) << messages(solver);
}

// After Bullet's SoftDemo, Init_Cloth.
/// Five bodies fall on a sheet that is held at its corners.
struct Heap {
    double fastest = 0.0;   ///< body at any time (m/s)
    double farthest = 0.0;  ///< body from the sheet's middle in the end (m)

    explicit Heap(const StepSettings& step) {
        btGnnSoftBodySolver solver([&](const Garment& garment) {
            ClothStepperSettings settings;
            settings.step = step;
            return std::make_unique<ClothStepper>(garment, settings);
        });
        World world(&solver);
        btSoftBody* cloth = sheet(world, 8, 0, 25, 1 + 2 + 4 + 8);
        cloth->getCollisionShape()->setMargin(0.5);
        btSoftBody::Material* material = cloth->appendMaterial();
        material->m_kLST = 0.4f;
        cloth->generateBendingConstraints(2, material);
        cloth->setTotalMass(150);
        world.add(cloth);
        std::vector<btRigidBody*> bodies;
        for (int i = 0; i < 5; ++i) {
            btCollisionShape* shape = new btBoxShape({1, 1, 1});
            if (i % 3 == 1) shape = new btCylinderShape({0.75f, 0.75f, 0.75f});
            if (i % 3 == 2) shape = new btBoxShape({1.5f, 0.5f, 0.5f});
            bodies.push_back(world.add(shape, {0, static_cast<btScalar>(2 + 6 * i), 0}, false, 10));
        }
        for (int i = 0; i < fewer_if_sanitized(300); ++i) {
            world.step(1.0 / 60.0);
            for (const btRigidBody* body : bodies)
                fastest =
                    std::max(fastest, static_cast<double>(body->getLinearVelocity().length()));
        }
        for (const btRigidBody* body : bodies)
            farthest = std::max(
                farthest, static_cast<double>(body->getWorldTransform().getOrigin().length()));
    }
};

constexpr double kFallOf65Metres = 36.0;  // m/s: from 26 m into the sheet that hangs through

TEST(PinchedCloth, BodiesThatPileUpInASheetStayInIt) {
    const Heap heap(StepSettings::whole());
    EXPECT_LT(heap.fastest, kFallOf65Metres);
    EXPECT_LT(heap.farthest, 30.0);
}

// They take less of the sheet's swing away: the bodies bounce off over its edges.
TEST(PinchedCloth, BodiesThatPileUpInASheetAreNotThrownInSmallSteps) {
    EXPECT_LT(Heap(StepSettings::in_small_steps()).fastest, kFallOf65Metres);
}

// The reports' cases: far off a free corner, and along a free edge.
TEST(AnchoredBodies, ABodyBesideAFreeCornerSwings) {
    for (const btVector3& away : {btVector3(-0.3f, 0, 0), btVector3(0, 0, 0.3f),
                                  btVector3(0, -0.3f, 0), btVector3(-0.2f, 0.1f, 0.2f)}) {
        btGnnSoftBodySolver solver(quasi_newton());
        World world(&solver);
        btSoftBody* cloth = world.add(sheet(world, 0.4f, 1, 9, 1 + 2 + 8));
        btRigidBody* ball =
            world.add(new btSphereShape(0.1f), cloth->m_nodes[72].m_x + away, false, 5);
        cloth->appendAnchor(72, ball, true);
        double speed = 0.0;
        for (int i = 0; i < fewer_if_sanitized(300); ++i) {
            world.step(1.0 / 60.0);
            speed = std::max(speed, static_cast<double>(ball->getLinearVelocity().length()));
        }
        EXPECT_LT(speed, 8.0);  // that of a fall of 3 m
        EXPECT_GT(ball->getWorldTransform().getOrigin().y(), -2.0f);
    }
}

TEST(AnchoredBodies, ARodAlongAFreeEdgeSwings) {
    for (const btScalar mass : {0.05f, 0.5f, 5.0f, 50.0f})
        for (const btScalar off : {0.0f, 0.1f, 0.3f}) {
            SCOPED_TRACE(std::to_string(mass) + " kg, " + std::to_string(off) + " m");
            btGnnSoftBodySolver solver(quasi_newton());
            World world(&solver);
            btSoftBody* cloth = world.add(sheet(world, 0.4f, 1, 9, 1 + 2));
            btRigidBody* rod =
                world.add(new btBoxShape({0.4f, 0.02f, 0.02f}), {0, 1, 0.4f + off}, false, mass);
            for (int k = 72; k < 81; ++k) cloth->appendAnchor(k, rod, true);
            double speed = 0.0;
            for (int i = 0; i < fewer_if_sanitized(300); ++i) {
                world.step(1.0 / 60.0);
                speed = std::max(speed, static_cast<double>(rod->getLinearVelocity().length()));
            }
            EXPECT_LT(speed, 12.0);
            EXPECT_LT(highest(*cloth), 2.0);
        }
}

struct Swing {
    std::vector<double> turns;  ///< places beside the middle at which it turned round (m), of each
                                ///< way the first
    double pause = 0.0;         ///< longest time without any motion (s)
};

/// Of a body that hangs on a sheet which is held by one edge, and is let go aside.
Swing swing(double rate, double mass, int anchors, double seconds) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    constexpr int n = 9;
    constexpr btScalar size = 0.8f, aside = 0.5f;
    const btVector3 down(0, -size * std::cos(aside), size * std::sin(aside));
    const btVector3 left(-size / 2, 0, 0), right(size / 2, 0, 0);
    btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.info(), left, right, left + down,
                                                       right + down, n, n, 0, true);
    cloth->setTotalMass(0.2f);
    for (int i = 0; i < n; ++i) cloth->setMass(i, 0);
    world.add(cloth);
    const int middle = (n - 1) * n + n / 2;
    btRigidBody* body =
        world.add(new btBoxShape({0.05f, 0.05f, 0.05f}),
                  cloth->m_nodes[middle].m_x + btVector3(0, -0.05f, 0), false, btScalar(mass));
    body->setActivationState(DISABLE_DEACTIVATION);
    for (int k = 0; k < anchors; ++k) cloth->appendAnchor(middle - anchors / 2 + k, body, true);
    Swing swing;
    double last = 0.0, pause = 0.0;
    for (int k = 0; k < static_cast<int>(seconds * rate); ++k) {
        world.step(1.0 / rate);
        const auto velocity = static_cast<double>(body->getLinearVelocity().z());
        const auto place = static_cast<double>(body->getWorldTransform().getOrigin().z());
        const bool came_over = place * (swing.turns.empty() ? 1.0 : swing.turns.back()) < 0.0;
        if (velocity * last < 0.0 && came_over) swing.turns.push_back(place);
        pause = velocity == 0.0 ? pause + 1.0 / rate : 0.0;
        swing.pause = std::max(swing.pause, pause);
        if (velocity != 0.0) last = velocity;
    }
    return swing;
}

// A pendulum of 0.8 m takes 0.9 s for each way. It stopped for good where it turned round: what
// Bullet's steps lose of a fall, and cloth that bears a body gives back, was taken for made.
TEST(AnchoredBodies, ABodyOnAHangingSheetIsAPendulum) {
    constexpr double kRates[] = {60.0, 30.0, 240.0};
    for (int k = 0; k < fewer_if_sanitized(3); ++k)
        for (const double mass : {0.02, 0.2, 2.0}) {
            const double rate = kRates[k];
            const bool is_damped = rate < 50.0 && mass < 0.1;  // a light body, by long steps
            if (is_damped) continue;
            SCOPED_TRACE(std::to_string(rate) + " Hz, " + std::to_string(mass) + " kg");
            const Swing swung = swing(rate, mass, 1, 4.0);
            ASSERT_GE(swung.turns.size(), 3u);
            EXPECT_LT(swung.turns[0], -0.2);
            EXPECT_GT(swung.turns[1], 0.15);
            EXPECT_LT(swung.turns[2], -0.1);
            // A heavy body on light, stiff cloth in short steps still pauses where it turns round.
            EXPECT_LT(swung.pause, rate > 100.0 && mass > 1.0 ? 1.2 : 0.1);
        }
    EXPECT_GE(swing(60.0, 0.2, 5, 4.0).turns.size(), 3u);
}

// Soft cotton, and a body that it cannot hold.
TEST(AnchoredBodies, AnAnchorBeyondTheClothsReachIsTold) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5, 1 + 2));
    btRigidBody* post = world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {0, 0, 3.0f}, true);
    cloth->appendAnchor(22, post, btVector3(0, 0, 0), true);
    world.step(1.0 / 60.0, 10);
    EXPECT_NE(messages(solver).find("node 22"), std::string::npos) << messages(solver);
    EXPECT_NE(messages(solver).find("farther away than the cloth reaches"), std::string::npos);
}

}  // namespace cloth::pinched_cloth_test
