// Cloth in a world of multibodies, and on their links.

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bullet_ext/softBodyGarment.h"
#include "gnn/model/make_cloth.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::multibody_test {

using namespace cloth::test;

namespace {

constexpr int kNodes = 9;  // along a side
constexpr double h = 1.0 / 60.0;
const btVector3 kArm(0.5f, 0.06f, 0.2f);  // half extents

/// An arm that turns about the z axis at the origin, and points along x.
class ArmWorld {
 public:
    explicit ArmWorld(btSoftBodySolver* solver)
        : m_dispatcher(&m_config),
          m_world(&m_dispatcher, &m_broadphase, &m_solver, &m_config, solver),
          m_shape(kArm),
          m_multibody(1, 0, {0, 0, 0}, /*fixedBase=*/true, /*canSleep=*/true) {
        m_world.setGravity({0, -9.81f, 0});
        info().m_gravity = {0, -9.81f, 0};
        info().m_dispatcher = &m_dispatcher;
        info().m_broadphase = &m_broadphase;
        info().m_sparsesdf.Initialize();
        btVector3 inertia;
        m_shape.calculateLocalInertia(2, inertia);
        m_multibody.setupRevolute(0, 2, inertia, -1, btQuaternion::getIdentity(), {0, 0, 1},
                                  {0, 0, 0}, {kArm.x(), 0, 0});
        m_multibody.finalizeMultiDof();
        m_link = std::make_unique<btMultiBodyLinkCollider>(&m_multibody, 0);
        m_link->setCollisionShape(&m_shape);
        m_link->setWorldTransform(
            btTransform(btQuaternion::getIdentity(), btVector3(kArm.x(), 0, 0)));
        m_multibody.getLink(0).m_collider = m_link.get();
        m_world.addCollisionObject(m_link.get(), btBroadphaseProxy::DefaultFilter,
                                   btBroadphaseProxy::AllFilter);
        m_world.addMultiBody(&m_multibody);
        m_motor = std::make_unique<btMultiBodyJointMotor>(&m_multibody, 0, btScalar(0), 1000.0f);
        m_world.addMultiBodyConstraint(m_motor.get());
    }
    ~ArmWorld() {
        m_world.removeRigidBody(&m_ground);
        if (m_sheet) m_world.removeSoftBody(m_sheet.get());
        m_world.removeMultiBodyConstraint(m_motor.get());
        m_world.removeMultiBody(&m_multibody);
        m_world.removeCollisionObject(m_link.get());
    }

    btSoftBodyWorldInfo& info() { return m_world.getWorldInfo(); }
    btMultiBodyLinkCollider* link() { return m_link.get(); }
    btSoftBody& sheet() { return *m_sheet; }

    /// A sheet of 1 m x 1 m around a point.
    btSoftBody& addSheet(const btVector3& centre) {
        m_sheet.reset(patch(info(), centre, kNodes));
        m_world.addSoftBody(m_sheet.get());
        return *m_sheet;
    }
    /// A fixed box with its top at this height (m).
    void addGround(btScalar top) {
        m_ground.setWorldTransform(
            btTransform(btQuaternion::getIdentity(), btVector3(0, top - 0.5f, 0)));
        m_world.addRigidBody(&m_ground);
    }
    /// The edge of the sheet at its least x, on the arm from then on.
    void anchorEdge() {
        for (const int node : edge()) m_sheet->appendDeformableAnchor(node, link());
    }
    static std::vector<int> edge() {
        std::vector<int> nodes;
        for (int row = 0; row < kNodes; ++row) nodes.push_back(row * kNodes);
        return nodes;
    }
    void turn(double speed) {
        m_multibody.wakeUp();
        m_motor->setVelocityTarget(static_cast<btScalar>(speed));
    }
    /// @param impulse  that the motor gives in a step at most (N m s)
    void weaken(double impulse) { m_motor->setMaxAppliedImpulse(static_cast<btScalar>(impulse)); }
    void step(int count = 1) {
        for (int i = 0; i < count; ++i) m_world.stepSimulation(static_cast<btScalar>(h), 0);
    }
    double angle() const { return m_multibody.getJointPos(0); }
    /// Of the deepest node in the arm (m).
    double depth() const {
        double deepest = 0.0;
        for (int i = 0; i < m_sheet->m_nodes.size(); ++i) {
            const btVector3 at = m_link->getWorldTransform().invXform(m_sheet->m_nodes[i].m_x);
            const btVector3 inside = kArm - at.absolute();
            deepest = std::max(deepest, double(inside[inside.minAxis()]));
        }
        return deepest;
    }
    double longestEdge() const {
        const std::vector<double> now = lengthsAt(*m_sheet, nodePositions(*m_sheet));
        const std::vector<double> rest = restLengths(*m_sheet);
        double longest = 0.0;
        for (size_t i = 0; i < now.size(); ++i) longest = std::max(longest, now[i] / rest[i]);
        return longest;
    }

 private:
    btSoftBodyRigidBodyCollisionConfiguration m_config;
    btCollisionDispatcher m_dispatcher;
    btDbvtBroadphase m_broadphase;
    btMultiBodyConstraintSolver m_solver;
    btSoftMultiBodyDynamicsWorld m_world;
    btBoxShape m_shape, m_ground_shape{{3, 0.5f, 3}};
    btRigidBody m_ground{0, nullptr, &m_ground_shape};
    btMultiBody m_multibody;
    std::unique_ptr<btMultiBodyLinkCollider> m_link;
    std::unique_ptr<btMultiBodyJointMotor> m_motor;
    std::unique_ptr<btSoftBody> m_sheet;
};

StepperFactory stepper() {
    return [](const Garment& garment) { return make_cloth(garment); };
}

}  // namespace

TEST(Multibody, ClothHangsOverALinkThatMoves) {
    btGnnSoftBodySolver solver(stepper());
    ArmWorld world(&solver);
    btSoftBody& sheet = world.addSheet({0.5f, 0.08f, 0});
    sheet.m_cfg.kDF = 1;
    double deepest = 0.0;
    for (int frame = 0; frame < 240; ++frame) {
        if (frame > 120) world.turn(frame % 60 < 30 ? 0.3 : -0.3);
        world.step();
        deepest = std::max(deepest, world.depth());
        ASSERT_EQ(solver.status().clothBodies, 1);
    }
    EXPECT_LT(deepest, 1e-3);
    EXPECT_LT(world.longestEdge(), 1.1);
    const Points x = nodePositions(sheet);
    EXPECT_LT(x.col(1).minCoeff(), -0.2) << "its sides hang down";
    EXPECT_GT(x.col(1).maxCoeff(), 0.0) << "it lies on the arm";
    EXPECT_TRUE(solver.status().messages.empty()) << solver.status().messages[0].text;
}

TEST(Multibody, AnchoredNodesFollowTheirLink) {
    btGnnSoftBodySolver solver(stepper());
    ArmWorld world(&solver);
    btSoftBody& sheet = world.addSheet({1.55f, 0, 0});
    world.anchorEdge();
    std::vector<btVector3> places;
    for (const int node : ArmWorld::edge())
        places.push_back(world.link()->getWorldTransform().invXform(sheet.m_nodes[node].m_x));
    for (int frame = 0; frame < 180; ++frame) {
        world.turn(3.0 * std::cos(0.1 * frame));
        world.step();
        for (size_t k = 0; k < places.size(); ++k) {
            const btVector3 place = world.link()->getWorldTransform() * places[k];
            const btVector3 node = sheet.m_nodes[ArmWorld::edge()[k]].m_x;
            ASSERT_LT((node - place).length(), 1e-5f) << "frame " << frame;
        }
        ASSERT_LT(world.longestEdge(), 1.1) << "frame " << frame;
    }
    EXPECT_GT(std::abs(world.angle()), 0.05) << "it has moved";
    EXPECT_TRUE(solver.status().messages.empty()) << solver.status().messages[0].text;
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST(Multibody, ClothBetweenALinkAndTheGroundIsNotThrown) {
    btGnnSoftBodySolver solver(stepper());
    ArmWorld world(&solver);
    world.addGround(-0.1f);
    const btSoftBody& sheet = world.addSheet({0.7f, -0.09f, 0});
    world.step(30);
    world.weaken(1.0);
    world.turn(-1.0);
    for (int frame = 0; frame < 120; ++frame) {
        world.step();
        for (int i = 0; i < sheet.m_nodes.size(); ++i)
            ASSERT_LT(sheet.m_nodes[i].m_v.length(), 1.5f) << "frame " << frame;
    }
    EXPECT_LT(world.angle(), -0.02) << "it presses";
    EXPECT_LT(nodePositions(sheet).col(1).maxCoeff(), 0.05);
    EXPECT_EQ(solver.status().failedSteps, 0);
}

TEST(Multibody, LinksDoNotFeelCloth) {
    const auto swung = [](bool anchored) {
        btGnnSoftBodySolver solver(stepper());
        ArmWorld world(&solver);
        world.addSheet(anchored ? btVector3(1.55f, 0, 0) : btVector3(9, 0, 0));
        if (anchored) world.anchorEdge();
        world.weaken(0);
        world.step(60);
        return world.angle();
    };
    EXPECT_EQ(swung(true), swung(false));
}

TEST(Multibody, RemovedAnchorsLetGo) {
    btGnnSoftBodySolver solver(stepper());
    ArmWorld world(&solver);
    btSoftBody& sheet = world.addSheet({1.55f, 0, 0});
    world.anchorEdge();
    world.step(60);
    for (const int node : ArmWorld::edge()) sheet.removeAnchor(node);
    world.step(60);
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_LT(nodePositions(sheet).col(1).maxCoeff(), -1.0) << "it falls";
}

TEST(Multibody, AnchoredClothSleepsAndWakesWithItsLink) {
    btGnnSoftBodySolver solver(stepper());
    ArmWorld world(&solver);
    btSoftBody& sheet = world.addSheet({1.55f, 0, 0});
    sheet.m_cfg.kDP = 0.05f;  // comes to rest soon
    world.anchorEdge();
    int frame = 0;
    for (; frame < 1200 && solver.status().sleepingBodies == 0; ++frame) world.step();
    ASSERT_EQ(solver.status().sleepingBodies, 1);
    const Points rest = nodePositions(sheet);
    world.turn(1.0);
    world.step(30);
    EXPECT_EQ(solver.status().sleepingBodies, 0);
    EXPECT_GT((nodePositions(sheet) - rest).rowwise().norm().maxCoeff(), 0.1);
}

TEST(Multibody, AnchorsOfRigidBodiesThatDoNothingAreSaid) {
    btGnnSoftBodySolver solver(stepper());
    World world(&solver);
    btRigidBody* post = world.add(new btSphereShape(0.1f), {0, 2, 0});
    btSoftBody* sheet = world.add(patch(world.info(), {0, 0, 0}, kNodes));
    sheet->appendDeformableAnchor(0, post);
    world.step(h, 10);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    EXPECT_NE(solver.status().messages[0].text.find("appendAnchor()"), std::string::npos);
    EXPECT_LT(nodePositions(*sheet).row(0).y(), -0.05) << "it falls, as with Bullet's solver";
}

}  // namespace cloth::multibody_test
