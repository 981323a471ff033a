// A stepper with a time step of its own, as learned ones have, serves worlds of every rate.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "bullet_ext/softBodyGarment.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"

namespace cloth::time_step_test {

using namespace cloth::test;

namespace {

/// How a game calls stepSimulation() for `seconds`.
struct Clock {
    const char* name;
    std::function<void(btSoftRigidDynamicsWorld&, double)> run;
};

void call(btSoftRigidDynamicsWorld& world, double seconds, double frame, int substeps,
          double fixed) {
    const int frames = static_cast<int>(std::lround(seconds / frame));
    for (int i = 0; i < frames; ++i)
        world.stepSimulation(static_cast<btScalar>(frame), substeps, static_cast<btScalar>(fixed));
}

const std::vector<Clock>& clocks() {
    static const std::vector<Clock> all = {
        {"1/60 with Bullet's sub-steps",
         [](auto& w, double s) { call(w, s, 1.0 / 60, 1, 1.0 / 60); }},
        {"1/30 in sub-steps of 1/60", [](auto& w, double s) { call(w, s, 1.0 / 30, 4, 1.0 / 60); }},
        {"1/30 at once", [](auto& w, double s) { call(w, s, 1.0 / 30, 0, 0); }},
        {"1/120", [](auto& w, double s) { call(w, s, 1.0 / 120, 0, 0); }},
        {"1/60 in sub-steps of 1/240",
         [](auto& w, double s) { call(w, s, 1.0 / 60, 8, 1.0 / 240); }},
        {"variable frames",
         [](auto& w, double s) {
             double time = 0.0;
             for (int i = 0; time < s - 1e-9; ++i) {
                 const double frame = std::min(s - time, 0.008 + 0.012 * (i * 7 % 10) / 9.0);
                 w.stepSimulation(static_cast<btScalar>(frame), 0);
                 time += frame;
             }
         }},
    };
    return all;
}

double lowest(const btSoftBody& body) {
    double y = std::numeric_limits<double>::infinity();
    for (int i = 0; i < body.m_nodes.size(); ++i) y = std::min(y, node(body, i).y());
    return y;
}

}  // namespace

TEST(TimeSteps, ClothFallsAsGravitySays) {
    for (const Clock& clock : clocks()) {
        btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0, 3));
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5));
        clock.run(*world, 0.5);
        const double early = node(*cloth, 12).y();
        clock.run(*world, 1.0);
        // The gravity that acts is read off two places, which leaves out where a step's clock
        // starts: y = -g t (t + h) / 2 - c, and a tick's h is 1/30 s whatever the world's is.
        const double fallen = early - node(*cloth, 12).y();
        const double h = 1.0 / 30.0;
        const double expected = 9.81 * (1.5 * (1.5 + h) - 0.5 * (0.5 + h)) / 2;
        EXPECT_NEAR(fallen / expected, 1.0, 0.01) << clock.name;
        EXPECT_NEAR(cloth->m_nodes[12].m_v.y() / (-9.81 * 1.5), 1.0, 0.025) << clock.name;
    }
}

TEST(TimeSteps, APinnedSheetComesToTheSameRestShapeAtEveryRate) {
    std::vector<Points> shapes;
    for (const Clock& clock : clocks()) {
        btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0, 8));
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 9, 1 + 2));
        for (int second = 0; second < 20; ++second) {
            // Bullet's damping is per world step; the same in every second whatever the rate.
            clock.run(*world, 1.0);
            for (int i = 0; i < cloth->m_nodes.size(); ++i) cloth->m_nodes[i].m_v *= 0.3f;
        }
        shapes.push_back(nodePositions(*cloth));
        const double height = -lowest(*cloth);
        EXPECT_GT(height, 0.9) << clock.name;
        const double apart = (shapes.back() - shapes.front()).rowwise().norm().maxCoeff();
        EXPECT_LT(apart, 0.02 * height) << clock.name;
    }
}

TEST(TimeSteps, NothingStutters) {
    // A swinging sheet, seen at 240 Hz: no node's step may differ from the one before by more than
    // what the tick's straight lines allow, the change of velocity of one tick.
    btGnnSoftBodySolver solver(quasi_newton(1.0 / 30.0, 8));
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 9, 1 + 2));
    world.step(1.0 / 240.0, 8);
    Vec3 before = node(*cloth, 76), step = Vec3::Zero();
    int repeated = 0;
    double roughest = 0.0, fastest = 0.0;
    for (int i = 0; i < 240; ++i) {
        world.step(1.0 / 240.0);
        const Vec3 now = node(*cloth, 76), move = now - before;
        if (i > 0) roughest = std::max(roughest, (move - step).norm());
        if (i > 0) repeated += move.norm() < 0.05 * step.norm();
        fastest = std::max(fastest, move.norm());
        before = now;
        step = move;
    }
    EXPECT_EQ(repeated, 0);  // a still frame between moving ones is what an eye calls stutter
    EXPECT_LT(roughest, 0.5 * fastest);
}

// Light cloth in thick air is stopped within a few world steps, each of which takes half of the
// velocity that it sees. If all steps of a cloth step saw the same one, the cloth would fly back
// faster than it came.
TEST(TimeSteps, AirNeverTurnsClothRound) {
    for (double fixed : {0.0, 1.0 / 30}) {
        btGnnSoftBodySolver solver(free_fall(nullptr, fixed));
        World world(&solver);
        world.info().m_gravity.setZero();
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        cloth->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSided;
        cloth->m_cfg.kDG = 0.5f;
        cloth->setTotalMass(0.02f);
        cloth->setVelocity({0, 10, 0});
        double last = 10.0;
        for (int i = 0; i < 240; ++i) {
            world.step(1.0 / 240.0);
            const double velocity = static_cast<double>(cloth->m_nodes[12].m_v.y());
            ASSERT_LE(velocity, last + 1e-6) << fixed << " s, step " << i;
            ASSERT_GE(velocity, -1e-3) << fixed << " s, step " << i;
            last = velocity;
        }
        EXPECT_LT(last, 5.0) << fixed;
    }
}

TEST(TimeSteps, PinsInWindMoveByTheirVelocity) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5, 1));
    cloth->m_cfg.kDG = 0.5f;
    cloth->setWindVelocity({0, 0, 3});
    world.step(1.0 / 60.0);
    const double before = node(*cloth, 0).x();
    cloth->m_nodes[0].m_v = {0.6f, 0, 0};
    world.step(1.0 / 60.0);
    EXPECT_NEAR(node(*cloth, 0).x() - before, 0.01, 1e-5);
}

// Contacts move coarse cloth by millimetres in each step: in a step of microseconds that would be
// hundreds of metres in a second.
TEST(TimeSteps, WorldStepsOfMicrosecondsThrowNothing) {
    for (const double shortest : {1e-3, 1e-4, 1e-5, 1e-6}) {
        btGnnSoftBodySolver solver(
            [](const Garment& garment) { return std::make_unique<ClothStepper>(garment); });
        World world(&solver);
        world.add(new btBoxShape({0.2f, 0.2f, 0.2f}), {0, 0, 0});
        btSoftBody* cloth = world.add(patch(world.info(), {0.05f, 0.25f, 0.03f}, 11));
        double fastest = 0.0, before = 0.0;
        for (int i = 0; i < 40; ++i) {
            world.step(1.0 / 60.0);
            before = fastest_node(*cloth);
            for (int k = 0; k < 3; ++k) {
                world.step(shortest);
                fastest = std::max(fastest, fastest_node(*cloth) - before);
            }
        }
        EXPECT_LT(fastest, 4.0) << shortest;
        EXPECT_EQ(solver.status().failedSteps, 0);
    }
}

}  // namespace cloth::time_step_test
