// The hierarchies of obstacles belong to the world: more garments cost no more of them, and see the
// same.

#include <gtest/gtest.h>

#include "collision/proximity/obstacle_trees.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/bullet_ext/physical_steppers.h"
#include "tests/test_meshes.h"

namespace cloth::shared_obstacles_test {

using namespace cloth::test;

namespace {

constexpr double h = 1.0 / 60.0;

/// Steps a garment with hierarchies of its own.
class Private : public Stepper {
 public:
    explicit Private(std::unique_ptr<Stepper> inner) : m_inner(std::move(inner)) {}
    std::string name() const override { return m_inner->name(); }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        Boundary alone = boundary;
        alone.trees = nullptr;
        return m_inner->step(alone, dt, state);
    }
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_inner->internal_forces(x, forces);
    }

 private:
    std::unique_ptr<Stepper> m_inner;
};

StepperFactory private_quasi_newton() {
    return
        [](const Garment& garment) { return std::make_unique<Private>(quasi_newton()(garment)); };
}

/// A character that rises under patches of cloth, one over the other.
class Scene {
 public:
    Scene(const std::vector<int>& patch_sizes, const StepperFactory& factory)
        : m_solver(factory),
          m_world(&m_solver),
          m_character(m_world.add(new btSphereShape(0.3f), {0, 0, 0}, true)),
          m_now(m_ball.vertices) {
        btScalar y = 0.31f;
        for (const int n : patch_sizes) {
            m_cloth.push_back(m_world.add(patch(m_world.info(), {0, y, 0}, n)));
            y += 0.02f;
        }
    }
    /// Rises by 1 cm in `steps` world steps, in each by as much.
    void advance(int steps = 1) {
        Points next = m_now;
        next.col(1).array() += 0.01;
        m_solver.setAnimatedObstacle(m_character, m_faces, m_now, next, h * steps);
        m_world->stepSimulation(static_cast<btScalar>(h * steps), steps, static_cast<btScalar>(h));
        m_now = next;
    }
    void stand() { m_world.step(h); }

    ObstacleTrees::Counts counts() const { return m_solver.obstacleTrees().counts(); }
    const btGnnSoftBodySolver& solver() const { return m_solver; }

    std::vector<Vec3> nodes(size_t cloth) const {
        std::vector<Vec3> all;
        for (int i = 0; i < m_cloth[cloth]->m_nodes.size(); ++i)
            all.push_back(node(*m_cloth[cloth], i));
        return all;
    }

 private:
    TriMesh m_ball = sphere_mesh(0.3, 20);
    std::shared_ptr<const Faces> m_faces = std::make_shared<const Faces>(m_ball.faces);
    btGnnSoftBodySolver m_solver;
    World m_world;
    btRigidBody* m_character;
    Points m_now;
    std::vector<btSoftBody*> m_cloth;
};

}  // namespace

/// Each world step begins where the last one ended: what is new is the pose at its end.
TEST(SharedObstacles, TwoGarmentsOnOneCharacterShareOneRefit) {
    for (const std::vector<int>& patches : {std::vector<int>{13}, {13, 9}, {13, 9, 9}}) {
        Scene scene(patches, quasi_newton());
        for (int step = 0; step < 5; ++step) {
            scene.advance();
            EXPECT_EQ(scene.counts().builds, 1);
            EXPECT_EQ(scene.counts().surface_fits, 2 + step) << patches.size() << " garments";
        }
        EXPECT_EQ(scene.solver().status().steps, 5 * static_cast<long>(patches.size()));
        scene.stand();
        EXPECT_EQ(scene.counts().surface_fits, 6);
    }
}

TEST(SharedObstacles, MeshesThatStayAsTheyAreAreBuiltOnce) {
    const TriMesh ball = sphere_mesh(0.3, 20);
    btTriangleMesh triangles;
    const auto at = [&](Eigen::Index f, int c) {
        const Vec3 x = ball.vertices.row(ball.faces(f, c));
        return btVector3(btScalar(x.x()), btScalar(x.y()), btScalar(x.z()));
    };
    for (Eigen::Index f = 0; f < ball.faces.rows(); ++f)
        triangles.addTriangle(at(f, 0), at(f, 1), at(f, 2), true);
    btBvhTriangleMeshShape mesh(&triangles, true);
    btGnnSoftBodySolver solver(quasi_newton());
    World world(&solver);
    auto* compound = new btCompoundShape;
    compound->addChildShape(btTransform::getIdentity(), &mesh);
    world.add(compound, {0, 0, 0});
    world.add(patch(world.info(), {0, 0.31f, 0}, 9));
    world.step(h, 5);
    EXPECT_EQ(solver.obstacleTrees().counts().builds, 1);
    compound->updateChildTransform(0, btTransform(btQuaternion::getIdentity(), {0, -0.01f, 0}));
    world.step(h, 5);
    EXPECT_EQ(solver.obstacleTrees().counts().builds, 2);
}

TEST(SharedObstacles, StepsThatCutAnAnimationJoinToo) {
    Scene scene({13, 9}, quasi_newton());
    for (int frame = 1; frame <= 3; ++frame) {
        scene.advance(2);
        EXPECT_EQ(scene.counts().surface_fits, 1 + 2 * frame);
    }
}

TEST(SharedObstacles, GarmentsMoveAsWithHierarchiesOfTheirOwn) {
    Scene shared({13, 9}, quasi_newton()), own({13, 9}, private_quasi_newton());
    for (int step = 0; step < 10; ++step) {
        shared.advance();
        own.advance();
        EXPECT_EQ(shared.nodes(0), own.nodes(0)) << step;
        EXPECT_EQ(shared.nodes(1), own.nodes(1)) << step;
    }
    EXPECT_EQ(own.counts().surface_fits, 0);
}

TEST(SharedObstacles, SteppersOfOtherTimeStepsShareWhatTheyCan) {
    Scene scene({13, 9}, quasi_newton(1.0 / 30.0));
    for (int step = 0; step < 6; ++step) scene.advance();
    EXPECT_EQ(scene.counts().builds, 1);
    // Both garments look 1/30 s ahead in every other world step: two poses each time at most.
    EXPECT_LE(scene.counts().surface_fits, 6);
    EXPECT_GE(scene.counts().surface_fits, 4);
}

}  // namespace cloth::shared_obstacles_test
