// Bodies that move nothing are stepped at the same time, and nobody can tell.

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "bullet_ext/solveSteps.h"
#include "collision/proximity/obstacle_trees.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::parallel_stepping_test {

using namespace cloth::test;

namespace {

constexpr double h = 1.0 / 60.0;

/// OpenMP's number of threads during a test.
class Threads {
 public:
    explicit Threads(int threads) { omp_set_num_threads(threads); }
    ~Threads() { omp_set_num_threads(m_before); }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

 private:
    int m_before = omp_get_max_threads();
};

btGnnSolverSettings parallel_or_not(bool parallel) {
    btGnnSolverSettings settings = soft_cotton();
    settings.parallel = parallel;
    return settings;
}

/// Three rising characters under patches of cloth, of which one has a second one and one takes
/// steps of its own length; and a ball that falls through two patches, which it pushes.
class Scene {
 public:
    Scene(int threads, bool parallel)
        : m_threads(threads),
          m_solver(quasi_newton(0.0, 3), parallel_or_not(parallel)),
          m_world(&m_solver) {
        for (int k = 0; k < 3; ++k) {
            const btScalar x = 3.0F * static_cast<btScalar>(k);
            m_characters.push_back(m_world.add(new btSphereShape(0.3F), {x, 0, 0}, true));
            m_cloth.push_back(m_world.add(patch(m_world.info(), {x, 0.31F, 0}, 15)));
        }
        m_cloth.push_back(m_world.add(patch(m_world.info(), {3, 0.33F, 0}, 13)));
        m_solver.attach(m_cloth[0], Fabric::soft_cotton(), quasi_newton(1.0 / 30.0, 3));
        for (const btScalar y : {0.31F, 0.4F})
            m_cloth.push_back(m_world.add(patch(m_world.info(), {-3, y, 0}, 11, 1 + 2)));
        m_ball = m_world.add(new btSphereShape(0.2F), {-3, 0.7F, 0}, false, 0.2F);
    }

    void step() {
        const double y = 0.01 * m_step++;
        for (size_t k = 0; k < m_characters.size(); ++k) {
            const Eigen::RowVector3d now(3.0 * static_cast<double>(k), y, 0.0);
            m_solver.setAnimatedObstacle(
                m_characters[k], m_faces, m_character.vertices.rowwise() + now,
                m_character.vertices.rowwise() + (now + Eigen::RowVector3d(0, 0.01, 0)), h);
        }
        m_world.step(h);
    }

    std::vector<Vec3> places() const {
        std::vector<Vec3> all = {toVec3(m_ball->getWorldTransform().getOrigin())};
        for (const btSoftBody* cloth : m_cloth)
            for (int i = 0; i < cloth->m_nodes.size(); ++i) all.push_back(node(*cloth, i));
        return all;
    }
    const btGnnSoftBodySolver& solver() const { return m_solver; }

 private:
    Threads m_threads;
    TriMesh m_character = sphere_mesh(0.3, 20);
    std::shared_ptr<const Faces> m_faces = std::make_shared<const Faces>(m_character.faces);
    btGnnSoftBodySolver m_solver;
    World m_world;
    std::vector<btRigidBody*> m_characters;
    std::vector<btSoftBody*> m_cloth;
    btRigidBody* m_ball;
    int m_step = 0;
};

/// Every step waits for another to begin: for 5 s where it must come, for 20 ms otherwise.
class Meeting : public Stepper {
 public:
    struct Place {
        std::atomic<int> present{0};
        std::atomic<bool> met{false};
        std::chrono::milliseconds patience{20};
    };
    Meeting(std::shared_ptr<Place> place, bool independent)
        : m_place(std::move(place)), m_independent(independent) {}
    std::string name() const override { return "meeting"; }
    bool is_independent() const override { return m_independent; }
    StepReport step(const Boundary&, double dt, ClothState& state) override {
        const auto end = std::chrono::steady_clock::now() + m_place->patience;
        if (++m_place->present > 1) m_place->met = true;
        while (!m_place->met && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        --m_place->present;
        state.time += dt;
        return {};
    }

 private:
    std::shared_ptr<Place> m_place;
    bool m_independent;
};

/// Whether steps of two patches are made at the same time.
bool meet(const btGnnSolverSettings& settings, bool must, bool independent = true) {
    const Threads threads(2);
    const auto place = std::make_shared<Meeting::Place>();
    if (must) place->patience = std::chrono::seconds(5);
    btGnnSoftBodySolver solver(
        [&](const Garment&) { return std::make_unique<Meeting>(place, independent); }, settings);
    World world(&solver);
    for (const btScalar x : {0.0F, 3.0F}) world.add(patch(world.info(), {x, 0, 0}, 17));
    world.step(h);
    EXPECT_EQ(solver.status().steps, 2);
    return place->met;
}

}  // namespace

TEST(ParallelStepping, TheNumberOfThreadsDoesNotChangeABit) {
    std::vector<std::vector<Vec3>> expected;
    {
        Scene one_by_one(1, false);
        for (int step = 0; step < 12; ++step) {
            one_by_one.step();
            expected.push_back(one_by_one.places());
        }
        EXPECT_EQ(one_by_one.solver().status().failedSteps, 0);
    }
    for (const int threads : {1, 2, 3}) {
        Scene scene(threads, true);
        for (size_t step = 0; step < expected.size(); ++step) {
            scene.step();
            ASSERT_EQ(scene.places(), expected[step]) << threads << " threads, step " << step;
        }
        EXPECT_EQ(scene.solver().status().clothBodies, 6);
    }
}

TEST(ParallelStepping, GarmentsOfOneCharacterShareOneRefitInAnyThread) {
    for (const int threads : {1, 2}) {
        Scene scene(threads, true);
        scene.step();
        for (int step = 1; step < 5; ++step) {
            const ObstacleTrees::Counts before = scene.solver().obstacleTrees().counts();
            scene.step();
            const ObstacleTrees::Counts after = scene.solver().obstacleTrees().counts();
            EXPECT_EQ(after.builds, before.builds);
            // The first character is looked at 1/30 s ahead, in every other step.
            EXPECT_LE(after.surface_fits - before.surface_fits, 4) << threads;
            EXPECT_GE(after.surface_fits - before.surface_fits, 2) << threads;
        }
    }
}

TEST(ParallelStepping, TwoBodiesTakeTwoThreadsUnlessTheyMustNot) {
    btGnnSolverSettings settings;
    EXPECT_TRUE(meet(settings, true));
    EXPECT_FALSE(meet(settings, false, false)) << "steppers that do not say that they may";
    settings.parallel = false;
    EXPECT_FALSE(meet(settings, false));
    settings.parallel = true;
    settings.maxMs = 1e4;
    EXPECT_FALSE(meet(settings, false));
}

TEST(ParallelStepping, AllThreadsServeOneBodyWhereThatIsFaster) {
    EXPECT_TRUE(areFasterTogether({1000, 1000}, 2));
    EXPECT_TRUE(areFasterTogether(std::vector<long>(10, 1000), 8));
    EXPECT_FALSE(areFasterTogether({1000, 1000}, 1));
    EXPECT_FALSE(areFasterTogether({1000}, 2));
    EXPECT_FALSE(areFasterTogether({}, 2));
    EXPECT_FALSE(areFasterTogether({50000, 1000}, 2)) << "one would wait for the other";
    EXPECT_FALSE(areFasterTogether({1000, 1000}, 8)) << "six threads would have nothing to do";
    EXPECT_FALSE(areFasterTogether({50, 50}, 2)) << "not worth waking a thread";
}

}  // namespace cloth::parallel_stepping_test
