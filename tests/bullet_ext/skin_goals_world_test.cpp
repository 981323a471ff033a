// Skinned goals in a Bullet world: setGoalLimits(), setGoals() and teleport().
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bullet_ext/bulletTypes.h"
#include "bullet_ext/softBodyGarment.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::skin_goals_world_test {

using namespace cloth::test;

namespace {

constexpr double floats = 2e-6;  // m: what single precision leaves

StepperFactory quasi_newton() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

StepperFactory learned() {
    return [](const Garment& garment) {
        ClothSettings settings;
        settings.weights = std::make_shared<const EngineWeights>(
            Weights::load(asset_path("weights/small.safetensors")));
        return make_cloth(garment, settings);
    };
}

StepperFactory xpbd() {
    return [](const Garment& garment) { return std::make_unique<XpbdStepper>(garment); };
}

GoalLimits limits_of(const btSoftBody& body, double max_distance, double backstop) {
    GoalLimits limits;
    limits.max_distance.setConstant(body.m_nodes.size(), max_distance);
    limits.backstop.setConstant(body.m_nodes.size(), backstop);
    return limits;
}

Points upward(const btSoftBody& body) {
    return Vec3::UnitY().transpose().replicate(body.m_nodes.size(), 1);
}

/// How far the farthest node is from its goal, and the lowest below it (m).
double farthest(const btSoftBody& body, const Points& goals) {
    return (nodePositions(body) - goals).rowwise().norm().maxCoeff();
}
double lowest(const btSoftBody& body, const Points& goals) {
    return (nodePositions(body) - goals).col(1).minCoeff();
}

bool says(const btGnnSoftBodySolver& solver, const std::string& words) {
    for (const btGnnSolverMessage& message : solver.status().messages)
        if (message.text.find(words) != std::string::npos) return true;
    return false;
}

}  // namespace

TEST(SkinGoalsWorld, NodesStayWithinTheirLimitsAtEveryRate) {
    for (const StepperFactory& factory : {quasi_newton(), learned(), xpbd()})
        for (const double rate : {30.0, 60.0, 240.0}) {
            btGnnSoftBodySolver solver(factory);
            World world(&solver);
            btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 7));
            solver.setGoalLimits(body, limits_of(*body, 0.04, 0.01));
            const Points start = nodePositions(*body), up = upward(*body);
            Points now = start;
            // As steps of a network foresee it: straight on.
            for (int k = 1; k <= static_cast<int>(rate); ++k) {
                Points next = start;
                next.col(0).array() += 2.0 * k / rate;
                solver.setGoals(body, {now, next, up, up}, 1.0 / rate);
                world.step(1.0 / rate);
                now = next;
                ASSERT_LT(farthest(*body, now), 0.04 + floats) << rate << " " << k;
                ASSERT_GT(lowest(*body, now), -0.01 - floats) << rate << " " << k;
            }
            EXPECT_EQ(solver.status().failedSteps, 0);
            EXPECT_TRUE(solver.status().messages.empty());
        }
}

TEST(SkinGoalsWorld, SubStepsSeeTheirPartOfTheWay) {
    const auto log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver(
        [&](const Garment& garment) { return std::make_unique<FreeFall>(garment, log); });
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
    solver.setGoalLimits(body, limits_of(*body, 0.1, 0.1));
    const Points x = nodePositions(*body), up = upward(*body);
    Points later = x;
    later.col(2).array() += 1.0;
    solver.setGoals(body, {x, later, up, up}, 4.0 / 240.0);
    world->stepSimulation(1.0f / 60, 4, 1.0f / 240);
    world->stepSimulation(1.0f / 60, 4, 1.0f / 240);
    ASSERT_EQ(log->boundaries.size(), 8u);
    for (size_t k = 0; k < 8; ++k) {
        const SkinGoals& goals = log->boundaries[k].goals;
        const double from = std::min(1.0, 0.25 * static_cast<double>(k));
        const double to = std::min(1.0, from + 0.25);
        EXPECT_NEAR((goals.x0 - x).col(2).mean(), from, 1e-5) << k;
        EXPECT_NEAR((goals.x1 - x).col(2).mean(), to, 1e-5) << "they stand still from then on";
        EXPECT_EQ(goals.normal1, up);
    }
}

TEST(SkinGoalsWorld, LimitsWithoutGoalsHoldTheClothWhereItWasAndSaySo) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
    const Points start = nodePositions(*body);
    solver.attach(body);
    solver.setGoalLimits(body, limits_of(*body, 0.05, 0.1));
    world.step(1.0 / 60.0, 60);
    EXPECT_LT(farthest(*body, start), 0.05 + floats);
    EXPECT_TRUE(says(solver, "setGoals()"));
    solver.setGoalLimits(body, {});
    world.step(1.0 / 60.0, 30);
    EXPECT_GT(farthest(*body, start), 0.5) << "it is let go";
}

TEST(SkinGoalsWorld, LimitsOfAGarmentCountAndStayWhenPinsChange) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 5, 1));
    const Points start = nodePositions(*body);
    const Garment garment =
        garmentOfSoftBody(*body, Fabric::soft_cotton(), false)
            .with_goals(limits_of(*body, 0.03, std::numeric_limits<double>::infinity()));
    solver.attach(body, garment);
    solver.setGoals(body, SkinGoals::at(start));
    world.step(1.0 / 60.0, 10);
    body->setMass(7, 0);
    body->m_nodes[7].m_v.setZero();  // a velocity of a pin is a command
    world.step(1.0 / 60.0, 30);
    EXPECT_EQ(solver.garmentOf(body)->pins(), (std::vector<int>{0, 7}));
    EXPECT_LT(farthest(*body, start), 0.03 + floats);
    EXPECT_GT(farthest(*body, start), 0.01);
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST(SkinGoalsWorld, WrongArgumentsAreRefusedWithTheBodysName) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
    const Points x = nodePositions(*body), up = upward(*body);
    Points broken = x;
    broken(3, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(solver.setGoalLimits(nullptr, {}), ArgumentError);
    EXPECT_THROW(solver.setGoals(nullptr, SkinGoals::at(x)), ArgumentError);
    EXPECT_THROW(solver.teleport(nullptr, btTransform::getIdentity()), ArgumentError);
    GoalLimits few;
    few.max_distance.setZero(3);
    EXPECT_THROW(solver.setGoalLimits(body, few), ArgumentError);
    EXPECT_THROW(solver.setGoalLimits(body, limits_of(*body, -1.0, 0.0)), ArgumentError);
    for (const SkinGoals& goals :
         {SkinGoals::at(x.topRows(4)), SkinGoals::at(broken), SkinGoals::at(x, broken),
          SkinGoals{x, x, up.topRows(2), up}, SkinGoals()})
        EXPECT_THROW(solver.setGoals(body, goals), ArgumentError);
    EXPECT_THROW(solver.setGoals(body, SkinGoals::at(x), -1.0), ArgumentError);
    btTransform nowhere = btTransform::getIdentity();
    nowhere.setOrigin({std::numeric_limits<float>::quiet_NaN(), 0, 0});
    EXPECT_THROW(solver.teleport(body, nowhere), ArgumentError);
    const btTransform still = btTransform::getIdentity();
    const btMatrix3x3 turn(btQuaternion({0, 0, 1}, 1));
    for (const btVector3& scale : {btVector3(2, 2, 2), btVector3(0.01f, 0.01f, 0.01f),
                                   btVector3(-1, 1, 1), btVector3(0, 0, 0)}) {
        const btTransform scaled(turn.scaled(scale));
        EXPECT_THROW(solver.teleport(body, scaled), ArgumentError);
        EXPECT_THROW(solver.setRootMotion(body, still, scaled), ArgumentError);
    }
    EXPECT_NO_THROW(solver.setRootMotion(body, still, btTransform(turn)));
    try {
        solver.setGoals(body, SkinGoals::at(x.topRows(4)));
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find(softBodyName(*body)), std::string::npos);
    }
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST(SkinGoalsWorld, GoalsThatJumpAreToldOf) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
    solver.setGoalLimits(body, limits_of(*body, 0.1, 0.1));
    Points x = nodePositions(*body);
    solver.setGoals(body, SkinGoals::at(x), 1.0 / 60.0);
    world.step(1.0 / 60.0);
    x.col(0).array() += 0.1;
    solver.setGoals(body, SkinGoals::at(x), 1.0 / 60.0);
    world.step(1.0 / 60.0);
    EXPECT_FALSE(says(solver, "jumped"));
    x.col(0).array() += 2.0;
    solver.setGoals(body, SkinGoals::at(x), 1.0 / 60.0);
    world.step(1.0 / 60.0);
    EXPECT_TRUE(says(solver, "jumped"));
    EXPECT_TRUE(says(solver, "teleport()"));
    EXPECT_LT(farthest(*body, x), 0.1 + floats) << "they are obeyed all the same";
}

TEST(SkinGoalsWorld, ATeleportMovesAllAndDragsNothing) {
    for (const btGnnTeleport kind : {btGnnTeleport::keep, btGnnTeleport::reset}) {
        btGnnSoftBodySolver solver(quasi_newton());
        World world(&solver);
        btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 7, 1 + 2));
        solver.setGoalLimits(body, limits_of(*body, 0.3, 0.3));
        const Points goals = nodePositions(*body), up = upward(*body);
        solver.setGoals(body, SkinGoals::at(goals, up));
        world.step(1.0 / 60.0, 12);
        const Points before = nodePositions(*body);
        btTransform motion(btQuaternion({0, 1, 0}, 1.2f), {50, 3, -20});
        const Pose pose = toPose(motion);
        const auto moved = [&](const Points& x) -> Points {
            return (x * pose.linear().transpose()).rowwise() + pose.translation().transpose();
        };
        solver.teleport(body, motion, kind);
        const bool reset = kind == btGnnTeleport::reset;
        const Points after = moved(reset ? goals : before);
        EXPECT_LT(farthest(*body, after), 1e-4);
        const btVector3 velocity = body->m_nodes[20].m_v;
        EXPECT_EQ(velocity.length() == 0, reset);
        const Points goals_there = moved(goals);
        solver.setGoals(body, SkinGoals::at(goals_there, up));
        world.step(1.0 / 60.0);
        EXPECT_LT(farthest(*body, after), 0.08) << "a step from there";
        EXPECT_EQ(solver.status().failedSteps, 0);
        EXPECT_EQ(solver.status().cutSteps, 0);
        EXPECT_TRUE(solver.status().messages.empty());
    }
}

TEST(SkinGoalsWorld, AResetNeedsGoalsAndNoLimits) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 7, 1 + 2));
    const Points goals = nodePositions(*body);
    world.step(1.0 / 60.0, 12);
    const Points fallen = nodePositions(*body);
    const btTransform still = btTransform::getIdentity();
    solver.teleport(body, still, btGnnTeleport::reset);
    EXPECT_LT(farthest(*body, fallen), floats);
    EXPECT_TRUE(says(solver, "no goals"));
    solver.setGoals(body, SkinGoals::at(goals));
    solver.teleport(body, still, btGnnTeleport::reset);
    EXPECT_LT(farthest(*body, goals), floats);
    EXPECT_EQ(body->m_nodes[20].m_v.length(), 0);
}

TEST(SkinGoalsWorld, GoalsThatMoveWakeTheCloth) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
    solver.setGoalLimits(body, limits_of(*body, 0.0, 0.0));
    Points x = nodePositions(*body);
    const Points up = upward(*body);
    solver.setGoals(body, SkinGoals::at(x, up));
    world.step(1.0 / 60.0, 240);
    EXPECT_EQ(solver.status().sleepingBodies, 1);
    solver.setGoals(body, SkinGoals::at(x, up));
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().sleepingBodies, 1) << "they are where they were";
    Points later = x;
    later.col(1).array() += 0.05;
    solver.setGoals(body, {x, later, up, up});
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().sleepingBodies, 0);
    EXPECT_LT(farthest(*body, later), floats);
}

TEST(SkinGoalsWorld, ABodyThatFallsOnHeldClothIsNotThrown) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 9));
    solver.setGoalLimits(body, limits_of(*body, 0.1, 0.1));
    Points x = nodePositions(*body);
    const Points up = upward(*body);
    btRigidBody* ball = world.add(new btSphereShape(0.15f), {0, 1.3f, 0}, false, 0.05f);
    double fastest_up = 0.0;
    for (int k = 0; k < 120; ++k) {
        Points next = x;
        next.col(0).array() += 0.002;
        solver.setGoals(body, {x, next, up, up}, 1.0 / 60.0);
        world.step(1.0 / 60.0);
        x = next;
        EXPECT_LT(farthest(*body, x), 0.3) << "the ball has pushed it beyond, but not through";
        fastest_up = std::max(fastest_up, static_cast<double>(ball->getLinearVelocity().y()));
    }
    EXPECT_LT(fastest_up, 2.5) << "it fell at less";
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST(SkinGoalsWorld, ClothThatDoesNotFeelItsRootRidesWithIt) {
    for (const double share : {0.0, 0.5, 1.0}) {
        btGnnSoftBodySolver solver(quasi_newton());
        World world(&solver);
        world.info().m_gravity.setZero();
        btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}));
        const Points start = nodePositions(*body);
        solver.setInertia(body, share, share);
        Pose root = Pose::Identity();
        root.translation() = Vec3(0.3, 0.0, 0.2);
        const Pose first = root;
        for (int k = 0; k < 30; ++k) {
            Pose next = root;
            next.pretranslate(Vec3(0.1, 0.02, 0.0));
            next.rotate(Eigen::AngleAxisd(0.04, Vec3::UnitY()));
            const auto to_bullet = [](const Pose& pose) {
                const Eigen::Quaterniond turn(pose.linear());
                return btTransform(
                    btQuaternion(static_cast<btScalar>(turn.x()), static_cast<btScalar>(turn.y()),
                                 static_cast<btScalar>(turn.z()), static_cast<btScalar>(turn.w())),
                    toBullet(Vec3(pose.translation())));
            };
            solver.setRootMotion(body, to_bullet(root), to_bullet(next), 1.0 / 60.0);
            world.step(1.0 / 60.0);
            root = next;
        }
        const Points now = nodePositions(*body);
        const Points ridden = transformed(start, root * first.inverse());
        const Vec3 way = (now - start).colwise().mean();
        if (share == 0.0) {
            EXPECT_LT((now - ridden).rowwise().norm().maxCoeff(), 2e-3);
        }
        if (share == 1.0) {
            EXPECT_LT((now - start).rowwise().norm().maxCoeff(), 1e-6);
        }
        if (share == 0.5) {
            EXPECT_NEAR(way.y(), 0.5 * 30 * 0.02, 1e-3);
        }
        EXPECT_EQ(solver.status().failedSteps, 0);
    }
}

namespace {

/// Where the nodes of cloth that hangs from a runner are after a second, relative to the runner; a
/// runner of speed 0 stands.
Points hanging_from_a_runner(double inertia, float acceleration) {
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    btSoftBody* body = world.add(patch(world.info(), {0, 1, 0}, 7, 1 + 2));
    world.step(1.0 / 60.0, 60);
    solver.setInertia(body, inertia, inertia);
    btTransform root = btTransform::getIdentity();
    for (int k = 1; k <= 60; ++k) {
        const btVector3 move(0, 0, acceleration * static_cast<btScalar>(std::min(k, 30)));
        btTransform next = root;
        next.getOrigin() += move;
        solver.setRootMotion(body, root, next, 1.0 / 60.0);
        for (const int pin : solver.garmentOf(body)->pins()) body->m_nodes[pin].m_x += move;
        world.step(1.0 / 60.0);
        root = next;
    }
    EXPECT_EQ(solver.status().failedSteps, 0);
    return nodePositions(*body).rowwise() - toVec3(root.getOrigin()).transpose();
}

}  // namespace

TEST(SkinGoalsWorld, ClothOfARunnerHangsAsIfItStoodWhereItDoesNotFeelTheRun) {
    const Points standing = hanging_from_a_runner(1.0, 0.0f);
    const auto off = [&](const Points& x) { return (x - standing).rowwise().norm().maxCoeff(); };
    EXPECT_LT(off(hanging_from_a_runner(0.0, 0.002f)), 0.01);
    EXPECT_GT(off(hanging_from_a_runner(1.0, 0.002f)), 0.1);
}

}  // namespace cloth::skin_goals_world_test
