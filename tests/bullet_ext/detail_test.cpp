// Level of detail: what a body's cloth may cost, switched in mid-run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "bullet_ext/softBodyGarment.h"
#include "data/core/carry_over.h"
#include "data/core/errors.h"
#include "gnn/model/make_cloth.h"
#include "gnn/model/make_proxy_cloth.h"
#include "gnn/physics/stepper/embedded_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/test_meshes.h"

namespace cloth::detail_test {

using namespace cloth::test;

namespace {

constexpr double h = 1.0 / 60.0;

btGnnSolverSettings of_soft_cotton() {
    btGnnSolverSettings settings;
    settings.fabric = Fabric::soft_cotton();
    settings.sleepMotion = 0.0;
    return settings;
}

/// A sheet of 1 m that hangs by two corners and swings.
class SwingingSheet : public testing::Test {
 protected:
    SwingingSheet()
        : solver([](const Garment& garment) { return make_cloth(garment); }, of_soft_cotton()),
          world(&solver),
          cloth(world.add(patch(world.info(), {0, 0, 0}, 13, 1 + 2))) {}

    /// The largest change of a node's motion from one world step to the next (m), in so many steps.
    double largest_change(int steps) {
        double largest = 0.0;
        for (int k = 0; k < steps; ++k) {
            world.step(h);
            const Points now = nodePositions(*cloth);
            if (before.rows() > 0 && earlier.rows() > 0)
                largest =
                    std::max(largest, (now - 2.0 * before + earlier).rowwise().norm().maxCoeff());
            earlier = before;
            before = now;
        }
        return largest;
    }
    bool was_said(const std::string& words) const {
        for (const btGnnSolverMessage& message : solver.status().messages)
            if (message.text.find(words) != std::string::npos) return true;
        return false;
    }

    btGnnSoftBodySolver solver;
    World world;
    btSoftBody* cloth;
    Points before, earlier;
};

btGnnDetail iterations(int most) {
    btGnnDetail detail;
    detail.iterations = most;
    return detail;
}

btGnnDetail world_steps(int count) {
    btGnnDetail detail;
    detail.worldSteps = count;
    return detail;
}

}  // namespace

TEST_F(SwingingSheet, IterationsAreLimitedAndFreeAgain) {
    world.step(h);
    EXPECT_GE(solver.reportOf(cloth)->iterations, 6);
    solver.setDetail(cloth, iterations(3));
    for (int k = 0; k < 5; ++k) {
        world.step(h);
        const StepReport& report = *solver.reportOf(cloth);
        EXPECT_LE(report.iterations, 3 * report.substeps);
    }
    solver.setDetail(cloth, btGnnDetail::full());
    world.step(h);
    EXPECT_GE(solver.reportOf(cloth)->iterations, 6);
}

TEST_F(SwingingSheet, TheLimitOutlivesANewStepper) {
    solver.setDetail(cloth, iterations(3));
    world.step(h);
    EXPECT_LE(solver.reportOf(cloth)->iterations, 3);
    cloth->setMass(168, 0);
    world.step(h);
    EXPECT_LE(solver.reportOf(cloth)->iterations, 3);
}

TEST_F(SwingingSheet, ALongClothStepServesSeveralWorldSteps) {
    solver.setDetail(cloth, world_steps(4));
    world.step(h, 40);
    EXPECT_EQ(solver.status().steps, 10);
    // It falls in every world step, on the straight line between the ends of a cloth step.
    const Points first = nodePositions(*cloth);
    world.step(h);
    const Points second = nodePositions(*cloth);
    world.step(h);
    const Points third = nodePositions(*cloth);
    EXPECT_GT((second - first).rowwise().norm().maxCoeff(), 1e-3);
    EXPECT_LT((third - 2.0 * second + first).rowwise().norm().maxCoeff(), 1e-6);
}

TEST_F(SwingingSheet, NothingJumpsWhereDetailIsSwitched) {
    // At the end of a cloth step of 8 world steps the motion changes by what 8 would change it.
    solver.setDetail(cloth, world_steps(8));
    const double usual = largest_change(64);
    double switched = 0.0;
    for (const btGnnDetail& detail :
         {btGnnDetail::reduced(), btGnnDetail::full(), world_steps(3), iterations(1),
          world_steps(8), btGnnDetail::full(), btGnnDetail::reduced(), btGnnDetail::full()}) {
        solver.setDetail(cloth, detail);
        switched = std::max(switched, largest_change(7));
    }
    EXPECT_LT(switched, 1.2 * usual);
    EXPECT_GT(switched, 0.0);
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST_F(SwingingSheet, OffScreenItKeepsItsShapeAndCostsNothing) {
    world.step(h, 20);
    const long steps = solver.status().steps;
    const Points shape = nodePositions(*cloth);
    solver.setDetail(cloth, btGnnDetail::offScreen());
    world.step(h, 30);
    EXPECT_EQ(solver.status().steps, steps);
    EXPECT_EQ(solver.status().carriedBodies, 1);
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_EQ(solver.status().times.total(), 0.0);
    EXPECT_EQ(nodePositions(*cloth), shape);
    solver.setDetail(cloth, btGnnDetail::full());
    world.step(h);
    EXPECT_EQ(solver.status().carriedBodies, 0);
    // It rests, and begins to fall.
    EXPECT_LT((nodePositions(*cloth) - shape).rowwise().norm().maxCoeff(), 0.02);
    EXPECT_GT((nodePositions(*cloth) - shape).rowwise().norm().maxCoeff(), 1e-4);
}

TEST_F(SwingingSheet, OffScreenItMovesWithItsRootAndKeepsItsPins) {
    world.step(h, 20);
    const Points shape = nodePositions(*cloth);
    solver.setDetail(cloth, btGnnDetail::offScreen());
    const btTransform motion(btQuaternion({0, 1, 0}, 0.01f), {0.05f, 0, 0});
    btTransform root = btTransform::getIdentity();
    for (int k = 0; k < 20; ++k) {
        const btTransform next = motion * root;
        solver.setRootMotion(cloth, root, next);
        for (const int pin : pinnedNodes(*cloth))
            cloth->m_nodes[pin].m_x = motion * cloth->m_nodes[pin].m_x;
        root = next;
        world.step(h);
        const Points expected = transformed(shape, toPose(root));
        ASSERT_LT((nodePositions(*cloth) - expected).rowwise().norm().maxCoeff(), 1e-4) << k;
    }
    // It goes on with the velocity of that motion.
    const Points last = nodePositions(*cloth);
    solver.setDetail(cloth, btGnnDetail::full());
    const btTransform next = motion * root;
    solver.setRootMotion(cloth, root, next);
    for (const int pin : pinnedNodes(*cloth))
        cloth->m_nodes[pin].m_x = motion * cloth->m_nodes[pin].m_x;
    world.step(h);
    const Points expected = transformed(last, toPose(motion));
    EXPECT_LT((nodePositions(*cloth) - expected).rowwise().norm().maxCoeff(), 0.02);
}

TEST_F(SwingingSheet, OffScreenItMovesWithTheMeanOfItsPins) {
    world.step(h, 20);
    const Points shape = nodePositions(*cloth);
    solver.setDetail(cloth, btGnnDetail::offScreen());
    for (int k = 1; k <= 10; ++k) {
        for (const int pin : pinnedNodes(*cloth)) cloth->m_nodes[pin].m_x += btVector3(0, 0.1f, 0);
        world.step(h);
    }
    const Points expected = shape.rowwise() + Eigen::RowVector3d(0.0, 1.0, 0.0);
    EXPECT_LT((nodePositions(*cloth) - expected).rowwise().norm().maxCoeff(), 1e-4);
}

TEST_F(SwingingSheet, AProxyTakesOverInMidRun) {
    largest_change(30);
    const Points x = nodePositions(*cloth);
    const double usual = largest_change(2);
    const Garment fine = *solver.garmentOf(cloth);
    const auto on_proxy = [](const Garment& garment) -> std::unique_ptr<Stepper> {
        TriMesh coarse = square_mesh(7);
        coarse.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.0, 0.5);
        const auto proxy = std::make_shared<const Garment>(carry_over(garment, coarse, "proxy"));
        return std::make_unique<EmbeddedStepper>(garment, proxy, make_cloth(*proxy));
    };
    solver.attach(cloth, fine, on_proxy);
    EXPECT_LT(largest_change(10), 4.0 * usual + 2e-3);
    EXPECT_EQ(solver.stepperOf(cloth)->name(), "quasi-newton-3s120~49");
    solver.setDetail(cloth, btGnnDetail::reduced());
    world.step(h);
    EXPECT_LE(solver.reportOf(cloth)->iterations, 3);
    solver.setDetail(cloth, btGnnDetail::full());
    solver.attach(cloth, fine);
    EXPECT_LT(largest_change(10), 4.0 * usual + 2e-3);
    EXPECT_EQ(solver.stepperOf(cloth)->name(), "quasi-newton-3s120");
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST_F(SwingingSheet, AProxyWithDetailTakesOverInMidRun) {
    largest_change(30);
    const double usual = largest_change(2);
    const auto on_proxy = [](const Garment& garment) -> std::unique_ptr<Stepper> {
        TriMesh coarse = square_mesh(7);
        coarse.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.0, 0.5);
        return make_proxy_cloth(
            garment, std::make_shared<const Garment>(carry_over(garment, coarse, "proxy")));
    };
    solver.attach(cloth, Garment(*solver.garmentOf(cloth)), on_proxy);
    EXPECT_LT(largest_change(10), 4.0 * usual + 2e-3);
    EXPECT_EQ(solver.stepperOf(cloth)->name(), "quasi-newton-3s120~49+quasi-newton-1");
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST_F(SwingingSheet, SteppersWithoutIterationsSaySo) {
    solver.attach(cloth, Fabric::soft_cotton(),
                  [](const Garment& garment) { return std::make_unique<XpbdStepper>(garment); });
    solver.setDetail(cloth, world_steps(2));
    EXPECT_TRUE(solver.status().messages.empty());
    solver.setDetail(cloth, btGnnDetail::reduced());
    EXPECT_TRUE(was_said("no iterations that setDetail() could limit"));
}

TEST_F(SwingingSheet, BadDetailIsRefusedByName) {
    const auto refusal = [&](btSoftBody* body, const btGnnDetail& detail) -> std::string {
        try {
            solver.setDetail(body, detail);
        } catch (const ArgumentError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(refusal(nullptr, {}).find("null"), std::string::npos);
    EXPECT_NE(refusal(cloth, iterations(-1)).find("iterations"), std::string::npos);
    EXPECT_NE(refusal(cloth, iterations(1001)).find("iterations"), std::string::npos);
    EXPECT_NE(refusal(cloth, world_steps(0)).find("worldSteps"), std::string::npos);
    EXPECT_NE(refusal(cloth, world_steps(9)).find("worldSteps"), std::string::npos);
}

}  // namespace cloth::detail_test
