#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/garmentSoftBody.h"
#include "bullet_ext/softBodyGarment.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/test_meshes.h"

namespace cloth::gnn_soft_body_solver_test {

using namespace cloth::test;

namespace {

std::vector<btVector3> positions(const btSoftBody& body) {
    std::vector<btVector3> x;
    for (int i = 0; i < body.m_nodes.size(); ++i) x.push_back(body.m_nodes[i].m_x);
    return x;
}

void expect_same(const std::vector<btVector3>& a, const std::vector<btVector3>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c) ASSERT_EQ(a[i][c], b[i][c]) << "node " << i;
}

std::string attach_error(btGnnSoftBodySolver& solver, btSoftBody* body) {
    try {
        solver.attach(body);
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "no error";
}

void expect_contains(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace

/// Says that it is inside limbs that it ignores.
class InIgnoredLimbs : public Stepper {
 public:
    explicit InIgnoredLimbs(double depth) : m_depth(depth) {}
    std::string name() const override { return "in ignored limbs"; }
    StepReport step(const Boundary&, double, ClothState&) override {
        StepReport report;
        report.max_ignored_depth = m_depth;
        report.vertices_in_ignored_limbs = 3;
        return report;
    }

 private:
    double m_depth;
};

TEST(GnnSolver, StatusTellsWhatIsInsideLimbsThatItIgnores) {
    double depth = 0.0;
    btGnnSoftBodySolver solver([&](const Garment&) {
        depth += 0.006;
        return std::make_unique<InIgnoredLimbs>(depth);
    });
    World world(&solver);
    world.add(patch(world.info(), {0, 2, 0}));
    world.add(patch(world.info(), {0, 3, 0}));
    for (int step = 0; step < 2; ++step) {
        world.step(1.0 / 60.0, 1);
        EXPECT_EQ(solver.status().maxIgnoredDepth, 0.012);
        EXPECT_EQ(solver.status().nodesInIgnoredLimbs, 6);
        EXPECT_EQ(solver.status().maxPenetration, 0.0);
    }
}

/// Takes down the limit that it is given.
class Limited : public InIgnoredLimbs {
 public:
    explicit Limited(std::vector<double>& limits) : InIgnoredLimbs(0.0), m_limits(&limits) {}
    bool set_max_ms(double ms) override {
        m_limits->push_back(ms);
        return true;
    }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        StepReport report = InIgnoredLimbs::step(boundary, dt, state);
        report.out_of_time = true;
        return report;
    }

 private:
    std::vector<double>* m_limits;
};

TEST(GnnSolver, TheTimeOfAWorldStepIsSharedByItsCloth) {
    constexpr double kMaxMs = 1e6;
    for (const double maxMs : {kMaxMs, std::numeric_limits<double>::infinity()}) {
        std::vector<double> limits;
        btGnnSolverSettings settings;
        settings.maxMs = maxMs;
        btGnnSoftBodySolver solver(
            [&](const Garment&) { return std::make_unique<Limited>(limits); }, settings);
        World world(&solver);
        world.add(patch(world.info(), {0, 2, 0}));
        world.add(patch(world.info(), {0, 3, 0}));
        world.step(1.0 / 60.0, 1);
        EXPECT_EQ(solver.status().shortenedSteps, 2);
        if (maxMs != kMaxMs) {
            EXPECT_TRUE(limits.empty()) << "what the steppers' own settings say counts";
            continue;
        }
        ASSERT_EQ(limits.size(), 2u);
        EXPECT_NEAR(limits[0], kMaxMs / 2, 1e-2 * kMaxMs);
        EXPECT_NEAR(limits[1], kMaxMs, 1e-2 * kMaxMs) << "the first one took hardly any";
    }
}

TEST(GnnSolver, TimesOutOfRangeAreRefused) {
    btGnnSolverSettings settings;
    for (const double bad : {0.0, 0.05, std::numeric_limits<double>::quiet_NaN()}) {
        settings.maxMs = bad;
        EXPECT_THROW(btGnnSoftBodySolver(free_fall(), settings), ArgumentError);
    }
}

TEST(GnnSolver, FreeFallIsTheClosedFormAtTheWorldsTimeStep) {
    for (double rate : {60.0, 240.0}) {
        btGnnSoftBodySolver solver(free_fall());
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 2, 0}));
        const int count = static_cast<int>(rate / 2);
        world.step(1.0 / rate, count);
        // Semi-implicit Euler: y = -g h^2 n (n + 1) / 2.
        const double expected = -9.81 / (rate * rate) * count * (count + 1) / 2;
        EXPECT_NEAR(node(*cloth, 7).y() - 2.0, expected, 1e-4);
        EXPECT_NEAR(cloth->m_nodes[7].m_v.y(), -9.81 * 0.5, 1e-3);
        EXPECT_EQ(solver.status().clothBodies, 1);
        EXPECT_EQ(solver.status().bulletBodies, 0);
        EXPECT_EQ(solver.status().steps, count);
    }
}

TEST(GnnSolver, GravityIsTheSoftBodysNotTheWorlds) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    world->setGravity({0, 5, 0});
    world.info().m_gravity = {1, 0, 0};
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(0.1);
    EXPECT_NEAR(cloth->m_nodes[3].m_v.x(), 0.1, 1e-6);
    EXPECT_EQ(cloth->m_nodes[3].m_v.y(), 0);
}

TEST(GnnSolver, StepperWithItsOwnTimeStepFallsAtTheSameRateInAnyWorld) {
    for (double rate : {15.0, 30.0, 50.0, 60.0, 240.0}) {
        auto log = std::make_shared<FreeFall::Log>();
        btGnnSoftBodySolver solver(free_fall(log, 1.0 / 30.0));
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        world.step(1.0 / rate, static_cast<int>(rate));
        EXPECT_EQ(log->dts.size(), 30u) << rate;
        // 1 s at 30 Hz: -g / 30^2 * 30 * 31 / 2; ticks and world steps end together here.
        EXPECT_NEAR(node(*cloth, 0).y(), -9.81 * 31 / 60, 1e-3) << rate;
        EXPECT_NEAR(cloth->m_nodes[0].m_v.y(), -9.81, 1e-3) << rate;
    }
}

TEST(GnnSolver, NodesMoveEvenlyBetweenTicks) {
    btGnnSoftBodySolver solver(free_fall(nullptr, 1.0 / 30.0));
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 240.0);
    const double first = node(*cloth, 0).y();
    for (int i = 2; i <= 8; ++i) {
        world.step(1.0 / 240.0);
        EXPECT_NEAR(node(*cloth, 0).y(), i * first, 1e-6);
    }
    EXPECT_NEAR(8 * first, -9.81 / 900.0, 1e-6);
}

TEST(GnnSolver, PinnedNodesStayOrGoWhereTheyAreSent) {
    for (double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(free_fall(nullptr, fixed));
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 1, 0}, 5, 1 + 2));
        const Vec3 start = node(*cloth, 0);
        ASSERT_EQ(cloth->m_nodes[4].m_im, 0);
        cloth->m_nodes[4].m_v = {0, 0.6f, 0};
        world.step(1.0 / 60.0, 30);
        EXPECT_EQ(node(*cloth, 0), start);
        EXPECT_NEAR(node(*cloth, 4).y(), 1.0 + 0.3, 1e-4);
        cloth->m_nodes[0].m_x += btVector3(0.1f, 0, 0);
        world.step(1.0 / 60.0);
        EXPECT_NEAR(node(*cloth, 0).x(), start.x() + 0.1, 1e-6);
    }
}

TEST(GnnSolver, StepperIsToldWherePinsEnd) {
    auto log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver(free_fall(log, 1.0 / 30.0));
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 1, 0}, 5, 1));
    const double speed = 0.9;
    for (int i = 0; i < 16; ++i) {  // a pin that is moved by hand every 1/240 s
        cloth->m_nodes[0].m_x += btVector3(static_cast<btScalar>(speed / 240.0), 0, 0);
        world.step(1.0 / 240.0);
    }
    ASSERT_EQ(log->boundaries.size(), 2u);
    // The second tick knows how the pin went on in the first one.
    EXPECT_NEAR(log->boundaries[1].pin_targets(0, 0), -0.5 + speed * 2.0 / 30.0, 1e-5);
}

TEST(GnnSolver, AnchoredNodesFollowTheirRigidBody) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btRigidBody* box = world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {-0.5f, 5, -0.5f}, true);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 1, 0}));
    cloth->appendAnchor(0, box, true);
    for (int i = 0; i < 30; ++i) {
        btTransform t = box->getWorldTransform();
        t.getOrigin() += btVector3(0.01f, 0, 0);
        box->setWorldTransform(t);
        world.step(1.0 / 60.0);
    }
    EXPECT_NEAR((node(*cloth, 0) - Vec3(-0.5 + 0.3, 1, -0.5)).norm(), 0.0, 1e-5);
    EXPECT_LT(node(*cloth, 1).y(), 0.5);
    cloth->m_anchors.clear();
    world.step(1.0 / 60.0);
    EXPECT_LT(node(*cloth, 0).y(), 1.0);
}

TEST(GnnSolver, UserChangesToFreeNodesCount) {
    for (double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(free_fall(nullptr, fixed));
        World world(&solver);
        world.info().m_gravity.setZero();
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        world.step(1.0 / 60.0, 3);
        cloth->m_nodes[6].m_x += btVector3(0, 0.5f, 0);
        cloth->m_nodes[8].m_v = {0, 0, 1.2f};
        world.step(1.0 / 60.0, 10);
        EXPECT_NEAR(node(*cloth, 6).y(), 0.5, 1e-6);
        EXPECT_NEAR(node(*cloth, 8).z() - node(*cloth, 7).z(), 0.2, 1e-4);
        cloth->translate({0, 3, 0});
        world.step(1.0 / 60.0);
        EXPECT_NEAR(node(*cloth, 0).y(), 3.0, 1e-5);
    }
}

TEST(GnnSolver, NodeForcesActAsImpulses) {
    for (double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(free_fall(nullptr, fixed));
        World world(&solver);
        world.info().m_gravity.setZero();
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        const double mass = 1.0 / static_cast<double>(cloth->m_nodes[12].m_im);
        for (int i = 0; i < 60; ++i) {
            cloth->addForce({0, 3, 0}, 12);
            world.step(1.0 / 60.0);
        }
        world.step(1.0 / 60.0, 2);
        EXPECT_NEAR(cloth->m_nodes[12].m_v.y(), 3.0 / mass, 0.02 * 3.0 / mass) << fixed;
        EXPECT_EQ(cloth->m_nodes[0].m_v.y(), 0) << fixed;
    }
}

TEST(GnnSolver, WindPushesClothAsMuchAsWithBulletsSolver) {
    btGnnSoftBodySolver solver(free_fall());
    World ours(&solver), bullets;
    btSoftBody* cloth[2];
    World* worlds[2] = {&ours, &bullets};
    for (int w = 0; w < 2; ++w) {
        World& world = *worlds[w];
        world.info().m_gravity = {0, 0, 1};  // Bullet's wind does not start cloth at rest
        cloth[w] = world.add(patch(world.info(), {0, 0, 0}));
        cloth[w]->m_cfg.aeromodel = btSoftBody::eAeroModel::F_TwoSided;
        cloth[w]->m_cfg.kDG = 0.5f;
        cloth[w]->m_materials[0]->m_kLST = 0;  // free fall has no stiffness either
        cloth[w]->setWindVelocity({0, 4, 0});
        world.step(1.0 / 60.0, 10);
    }
    const double expected = cloth[1]->m_nodes[12].m_v.y();
    EXPECT_GT(expected, 0.1);
    EXPECT_NEAR(cloth[0]->m_nodes[12].m_v.y(), expected, 0.01 * expected);
}

// Air takes motion, and turns it, but gives none. Bullet's lift in steps of finite length gives
// some: 0.08 J here. What remains is that gravity and air take turns.
TEST(GnnSolver, StillAirGivesNoEnergy) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = patch(world.info(), {0, 0, 0});
    cloth->rotate(btQuaternion({0.6f, 0, 0.8f}, 0.7f));
    world.add(cloth);
    cloth->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSided;
    cloth->m_cfg.kLF = 0.05f;
    cloth->m_cfg.kDG = 0.004f;
    cloth->setTotalMass(0.1f);
    const auto energy = [&] {
        double sum = 0.0;
        for (int i = 0; i < cloth->m_nodes.size(); ++i) {
            const btSoftBody::Node& node = cloth->m_nodes[i];
            sum += (0.5 * static_cast<double>(node.m_v.length2()) +
                    9.81 * static_cast<double>(node.m_x.y())) /
                   static_cast<double>(node.m_im);
        }
        return sum;
    };
    double least = energy(), rise = 0.0;
    for (int i = 0; i < 600; ++i) {
        world.step(1.0 / 60.0, 1);
        least = std::min(least, energy());
        rise = std::max(rise, energy() - least);
    }
    EXPECT_LT(rise, 0.02);
}

TEST(GnnSolver, DampingSlowsClothDownAtTheRateOfWorldSteps) {
    for (double fixed : {0.0, 1.0 / 30.0}) {
        btGnnSoftBodySolver solver(free_fall(nullptr, fixed));
        World world(&solver);
        world.info().m_gravity.setZero();
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        cloth->m_cfg.kDP = 0.1f;
        cloth->setVelocity({1, 0, 0});
        world.step(1.0 / 60.0, 10);
        EXPECT_NEAR(cloth->m_nodes[0].m_v.x(), std::pow(0.9, 10), 1e-4) << fixed;
    }
}

TEST(GnnSolver, NormalsBoundsTreesAndVertexBufferFollowTheNodes) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 3, 0}));
    btSoftBody::sRayCast hit;
    ASSERT_TRUE(cloth->rayTest({0.1f, 9, 0.1f}, {0.1f, -9, 0.1f}, hit));  // builds the face tree
    cloth->setVelocity({1, 0, 0});
    world.step(1.0 / 60.0, 60);
    const double y = node(*cloth, 0).y(), x = node(*cloth, 12).x();
    btVector3 low, high;
    cloth->getAabb(low, high);
    EXPECT_LE(low.y(), y);
    EXPECT_GE(high.y(), y);
    EXPECT_LT(high.y() - low.y(), 1.0f);
    EXPECT_NEAR(std::abs(cloth->m_nodes[12].m_n.y()), 1.0, 1e-3);
    const auto at = static_cast<btScalar>(x + 0.1);
    ASSERT_TRUE(cloth->rayTest({at, 9, 0.1f}, {at, -9, 0.1f}, hit));
    EXPECT_NEAR(9 - 18 * hit.fraction, y, 1e-3);
    btCollisionWorld::ClosestRayResultCallback ray({at, 9, 0.1f}, {at, -9, 0.1f});
    world->rayTest({at, 9, 0.1f}, {at, -9, 0.1f}, ray);
    ASSERT_TRUE(ray.hasHit());
    EXPECT_EQ(ray.m_collisionObject, cloth);
    std::vector<float> buffer(static_cast<size_t>(cloth->m_nodes.size()) * 6);
    btCPUVertexBufferDescriptor descriptor(buffer.data(), 0, 6, 3, 6);
    solver.copySoftBodyToVertexBuffer(cloth, &descriptor);
    EXPECT_EQ(buffer[12 * 6 + 1], cloth->m_nodes[12].m_x.y());
}

TEST(GnnSolver, PreviousPositionIsThatOfTheStepBefore) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 5);
    const btVector3 before = cloth->m_nodes[3].m_x;
    world.step(1.0 / 60.0);
    EXPECT_EQ(cloth->m_nodes[3].m_q, before);
}

TEST(GnnSolver, SoftBodiesThatAreNotClothMoveBitForBitAsWithBulletsSolver) {
    btGnnSoftBodySolver solver(free_fall());
    World ours(&solver), bullets;
    std::vector<btSoftBody*> others[2];
    World* worlds[2] = {&ours, &bullets};
    for (int w = 0; w < 2; ++w) {
        World& world = *worlds[w];
        world.add(new btBoxShape({5, 0.5f, 5}), {0, -0.5f, 0});
        if (w == 0) world.add(patch(world.info(), {0, 3, 0}));
        others[w].push_back(
            world.add(btSoftBodyHelpers::CreateRope(world.info(), {-1, 1, 0}, {1, 1, 0}, 12, 1)));
        btSoftBody* ball =
            btSoftBodyHelpers::CreateEllipsoid(world.info(), {0, 1, 2}, {0.3f, 0.3f, 0.3f}, 64);
        ball->m_cfg.kPR = 50;
        others[w].push_back(world.add(ball));
        btSoftBody* clusters =
            btSoftBodyHelpers::CreateEllipsoid(world.info(), {2, 1, 0}, {0.3f, 0.3f, 0.3f}, 64);
        clusters->m_cfg.collisions = btSoftBody::fCollision::CL_RS;
        clusters->generateClusters(8);
        others[w].push_back(world.add(clusters));
        const btVector3 corners[] = {{-2, 1, 0}, {-1.6f, 1, 0}, {-2, 1.4f, 0}, {-2, 1, 0.4f}};
        const btScalar masses[] = {1, 1, 1, 1};
        auto* tetra = new btSoftBody(&world.info(), 4, corners, masses);
        tetra->appendTetra(0, 1, 2, 3);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j) tetra->appendLink(i, j);
        others[w].push_back(world.add(tetra));
        world.step(1.0 / 60.0, 60);
    }
    for (size_t b = 0; b < others[0].size(); ++b)
        expect_same(positions(*others[0][b]), positions(*others[1][b]));
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_EQ(solver.status().bulletBodies, 4);
}

TEST(GnnSolver, DetachedClothMovesBitForBitAsWithBulletsSolver) {
    btGnnSoftBodySolver solver(free_fall());
    World ours(&solver), bullets;
    btSoftBody* a = ours.add(patch(ours.info(), {0, 1, 0}, 9, 1 + 2));
    btSoftBody* b = bullets.add(patch(bullets.info(), {0, 1, 0}, 9, 1 + 2));
    solver.detach(a);
    ours.step(1.0 / 60.0, 30);
    bullets.step(1.0 / 60.0, 30);
    expect_same(positions(*a), positions(*b));
}

TEST(GnnSolver, OrderOfBodiesAndObstaclesDoesNotChangeResults) {
    auto log_a = std::make_shared<FreeFall::Log>(), log_b = std::make_shared<FreeFall::Log>();
    std::vector<btVector3> results[2][2];
    std::shared_ptr<FreeFall::Log> logs[2] = {log_a, log_b};
    for (int order = 0; order < 2; ++order) {
        btGnnSoftBodySolver solver(free_fall(logs[order]));
        World world(&solver);
        const auto obstacle = [&](int i) {
            if (i == 0) world.add(new btSphereShape(0.2f), {0.3f, 0.9f, 0});
            if (i == 1) world.add(new btBoxShape({0.2f, 0.1f, 0.2f}), {-0.3f, 0.9f, 0});
            if (i == 2) world.add(new btSphereShape(0.2f), {0.1f, 0.9f, 0.2f});
        };
        btSoftBody* bodies[2];
        for (int i = 0; i < 3; ++i) obstacle(order ? 2 - i : i);
        for (int i = 0; i < 2; ++i) {
            const int which = order ? 1 - i : i;
            bodies[which] =
                world.add(patch(world.info(), {0, 1 + 2 * btScalar(which), 0}, 5, which));
        }
        world.step(1.0 / 60.0, 5);
        for (int i = 0; i < 2; ++i) results[order][i] = positions(*bodies[i]);
    }
    for (int i = 0; i < 2; ++i) expect_same(results[0][i], results[1][i]);
    const auto& a = log_a->boundaries[0].obstacles;
    const auto& b = log_b->boundaries[1].obstacles;  // the same cloth, second in the other order
    ASSERT_EQ(a.size(), 3u);
    ASSERT_EQ(b.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(a[i].shape, b[i].shape);
        EXPECT_EQ(a[i].pose1.matrix(), b[i].pose1.matrix());
    }
}

TEST(GnnSolver, BodiesComeAndGo) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* first = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 3);
    btSoftBody* second = world.add(patch(world.info(), {0, 5, 0}, 7));
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(solver.status().clothBodies, 2);
    world.remove(first);
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_EQ(solver.stepperOf(first), nullptr);
    btSoftBody* third = world.add(patch(world.info(), {0, 0, 0}, 4));
    world.step(1.0 / 60.0);
    EXPECT_NE(solver.stepperOf(third), nullptr);
    EXPECT_NEAR(third->m_nodes[0].m_v.y(), -9.81 / 60, 1e-4);
    EXPECT_NEAR(second->m_nodes[0].m_v.y(), -9.81 * 7 / 60, 1e-4);
}

TEST(GnnSolver, ANewBodyAtAnOldAddressIsANewBody) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = patch(world.info(), {0, 0, 0});
    world->addSoftBody(cloth);
    world.step(1.0 / 60.0, 3);
    world->removeSoftBody(cloth);
    cloth->~btSoftBody();
    const btVector3 x[] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
    const btScalar masses[] = {1, 1, 1, 1};
    new (cloth) btSoftBody(&world.info(), 4, x, masses);
    cloth->appendFace(0, 2, 1);
    cloth->appendFace(1, 2, 3);
    world.add(cloth);
    world.step(1.0 / 60.0);
    ASSERT_NE(solver.garmentOf(cloth), nullptr);
    EXPECT_EQ(solver.garmentOf(cloth)->vertex_count(), 4);
    EXPECT_NEAR(cloth->m_nodes[0].m_v.y(), -9.81 / 60, 1e-5);
}

TEST(GnnSolver, AddingABodyAgainStartsAfresh) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 3);
    solver.detach(cloth);
    world->removeSoftBody(cloth);
    world->addSoftBody(cloth);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().bulletBodies, 1);  // detach() came last
    world->removeSoftBody(cloth);
    world->addSoftBody(cloth);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().clothBodies, 1);
}

// In the world again, it is another body: with the same address it is like one that was made where
// another one was deleted.
TEST(GnnSolver, SettingsOfABodyThatLeftAreNotThoseOfTheNextAtItsAddress) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 5, 0}));
    const auto come_again = [&] {
        world->removeSoftBody(cloth);
        world->addSoftBody(cloth);
    };
    solver.setDetail(cloth, btGnnDetail::offScreen());
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(fastest_node(*cloth), 0.0);
    come_again();
    solver.attach(cloth);
    world.step(1.0 / 60.0, 3);
    EXPECT_NEAR(fastest_node(*cloth), 9.81 * 3 / 60, 1e-4) << "it is stepped";
    come_again();
    solver.setDetail(cloth, btGnnDetail::offScreen());
    const double y = node(*cloth, 0).y();
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(node(*cloth, 0).y(), y) << "what is asked of it before its first step counts";
}

TEST(GnnSolver, SettingsOfABodyThatLeftBeforeItsFirstStepAreNotThoseOfTheNext) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    const std::vector<std::function<void(btSoftBody*)>> settings = {
        [&](btSoftBody* body) { solver.setDetail(body, btGnnDetail::offScreen()); },
        [&](btSoftBody* body) {
            solver.attach(body);
            solver.setDetail(body, btGnnDetail::offScreen());
        },
        [&](btSoftBody* body) {
            solver.setDetail(body, btGnnDetail::offScreen());
            solver.attach(body, Fabric::soft_cotton());
        },
        [&](btSoftBody* body) {
            solver.setDetail(body, btGnnDetail::offScreen());
            solver.setInertia(body, 0.5, 0.5);
        }};
    for (const auto& set : settings) {
        btSoftBody* cloth = world.add(patch(world.info(), {0, 5, 0}));
        set(cloth);
        world->removeSoftBody(cloth);
        world->addSoftBody(cloth);  // as another one at its address
        world.step(1.0 / 60.0, 3);
        EXPECT_NEAR(fastest_node(*cloth), 9.81 * 3 / 60, 1e-4) << "it is stepped";
        world.remove(cloth);
    }
}

/// A level quad, in the memory of another body.
btSoftBody* quad_at(btSoftBody* memory, btSoftBodyWorldInfo& info) {
    memory->~btSoftBody();
    const btVector3 x[] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
    const btScalar masses[] = {1, 1, 1, 1};
    auto* quad = new (memory) btSoftBody(&info, 4, x, masses);
    quad->appendFace(0, 2, 1);
    quad->appendFace(1, 2, 3);
    return quad;
}

TEST(GnnSolver, SettingsOfABodyThatNeverWasInAWorldAreForOneOfItsSize) {
    const auto speed_of_next = [](bool same_size, bool forgotten, bool detached) {
        btGnnSoftBodySolver solver(free_fall());
        World world(&solver);
        btSoftBody* body = patch(world.info(), {0, 0, 0});
        if (same_size) body = quad_at(body, world.info());
        solver.attach(body);
        solver.setDetail(body, btGnnDetail::offScreen());
        if (detached) solver.detach(body);
        if (forgotten) solver.forget(body);
        body = world.add(quad_at(body, world.info()));
        world.step(1.0 / 60.0, 3);
        EXPECT_EQ(solver.status().bulletBodies, 0);
        return fastest_node(*body);
    };
    constexpr double fall = 9.81 * 3 / 60;
    EXPECT_NEAR(speed_of_next(false, false, false), fall, 1e-4);
    EXPECT_NEAR(speed_of_next(false, false, true), fall, 1e-4);
    EXPECT_EQ(speed_of_next(true, false, false), 0.0) << "it may be the same body";
    EXPECT_NEAR(speed_of_next(true, true, false), fall, 1e-4);
    EXPECT_NEAR(speed_of_next(true, true, true), fall, 1e-4);
}

TEST(GnnSolver, ClothThatIsPutElsewhereIsNotDraggedThereByItsPins) {
    for (const auto& fabric : {Fabric::soft_cotton(), Fabric::real_cotton()}) {
        btGnnSoftBodySolver solver(
            [](const Garment& garment) { return std::make_unique<ClothStepper>(garment); },
            {fabric});
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 1, 0}, 9, 1 + 2 + 4 + 8));
        cloth->m_cfg.kDP = 0.05f;
        world.step(1.0 / 60.0, 120);
        const Points before = nodePositions(*cloth);
        const double speed = fastest_node(*cloth);
        const btVector3 way(3, 1, 0);
        cloth->translate(way);
        for (int k = 0; k < 30; ++k) {
            world.step(1.0 / 60.0);
            EXPECT_LT(fastest_node(*cloth), speed + 0.1);
        }
        const Points moved = nodePositions(*cloth).rowwise() - toVec3(way).transpose();
        EXPECT_LT((moved - before).rowwise().norm().maxCoeff(), 0.02);
    }
}

TEST(GnnSolver, TimescaleStretchesTheClothsTimeOnly) {
    auto log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver(free_fall(log));
    World world(&solver);
    btRigidBody* sphere = world.add(new btSphereShape(0.1f), {0, -0.1f, 0}, true);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    cloth->m_cfg.timescale = 0.5f;
    world.step(1.0 / 60.0);
    EXPECT_NEAR(log->dts.at(0), 1.0 / 120.0, 1e-7);
    sphere->setWorldTransform(btTransform(btQuaternion::getIdentity(), {0.01f, -0.1f, 0}));
    world.step(1.0 / 60.0);
    EXPECT_NEAR(log->boundaries.at(1).obstacles.at(0).pose1.translation().x(), 0.01, 1e-6);
    const double y = node(*cloth, 0).y();
    cloth->m_cfg.timescale = 0;  // paused
    world.step(1.0 / 60.0, 5);
    EXPECT_EQ(node(*cloth, 0).y(), y);
}

bool tells(const btGnnSoftBodySolver& solver, const std::string& part) {
    const auto& messages = solver.status().messages;
    return std::any_of(messages.begin(), messages.end(), [&](const btGnnSolverMessage& message) {
        return message.text.find(part) != std::string::npos;
    });
}

TEST(GnnSolver, ATimescaleThatIsNoneIsTold) {
    for (const float scale : {-1.0f, std::numeric_limits<float>::quiet_NaN(), 0.0f, 2.0f}) {
        btGnnSoftBodySolver solver(free_fall());
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        cloth->m_cfg.timescale = scale;
        world.step(1.0 / 60.0);
        EXPECT_EQ(tells(solver, "timescale is negative or no number"), !(scale >= 0.0f)) << scale;
        EXPECT_EQ(fastest_node(*cloth) > 0.0, scale > 0.0f) << scale;
    }
}

TEST(GnnSolver, ClothThatWasPausedAndLeftBehindIsTold) {
    constexpr double h = 1.0 / 60.0;
    const auto is_told = [](double speed, bool follows) {
        btGnnSoftBodySolver solver(free_fall());
        World world(&solver);
        btRigidBody* character = world.add(new btSphereShape(0.3f), {0, 0, 0}, true);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        TriMesh ball = icosphere(2);
        ball.vertices *= 0.3;
        const auto faces = std::make_shared<const Faces>(ball.faces);
        Points x = ball.vertices;
        for (int step = 0; step < 12; ++step) {
            const Points before = x;
            if (step > 0) x.col(0).array() += speed * h;
            solver.setAnimatedObstacle(character, faces, before, x, h);
            cloth->m_cfg.timescale = step > 0 && step < 10 ? 0.0f : 1.0f;
            if (step == 10 && follows)
                solver.teleport(cloth, btTransform(btQuaternion::getIdentity(),
                                                   {static_cast<btScalar>(x(0, 0)), 0, 0}));
            world.step(h);
            EXPECT_EQ(tells(solver, "goes on alone"), step >= 10 && speed > 1.0 && !follows);
        }
        return tells(solver, "goes on alone");
    };
    EXPECT_TRUE(is_told(12.0, false));
    EXPECT_FALSE(is_told(12.0, true));
    EXPECT_FALSE(is_told(0.1, false));
}

TEST(GnnSolver, AnimatedObstaclesOfOneMeshAreToldApartInEveryStep) {
    constexpr double h = 1.0 / 60.0;
    auto log = std::make_shared<FreeFall::Log>();
    btGnnSoftBodySolver solver(free_fall(log));
    World world(&solver);
    btRigidBody* one = world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    btRigidBody* two = world.add(new btSphereShape(0.1f), {0, 0, 0}, true);
    world.add(patch(world.info(), {0, 0, 0}));
    TriMesh ball = icosphere(1);
    ball.vertices *= 0.1;
    const auto faces = std::make_shared<const Faces>(ball.faces);
    const auto at = [&](double x) -> Points {
        return ball.vertices.rowwise() + Eigen::RowVector3d(x, 0, 0);
    };
    const auto step = [&](double from, double to) {  // of the first; the other one comes towards it
        solver.setAnimatedObstacle(one, faces, at(from), at(to), h);
        solver.setAnimatedObstacle(two, faces, at(-from), at(-to), h);
        world.step(h);
        std::vector<std::pair<double, int>> seen;  // place and number
        for (const Obstacle& obstacle : log->boundaries.back().obstacles)
            seen.emplace_back(obstacle.x1.col(0).mean(), obstacle.id);
        std::sort(seen.begin(), seen.end());
        EXPECT_EQ(seen.size(), 2u);
        return seen;
    };
    const auto before = step(-0.1, -0.05), after = step(-0.05, 0.05);
    EXPECT_NE(before[0].second, 0);
    EXPECT_NE(before[0].second, before[1].second);
    EXPECT_EQ(before[0].second, after[1].second);
    EXPECT_EQ(before[1].second, after[0].second);
    solver.removeAnimatedObstacle(one);
    const auto anew = step(0.05, 0.05);
    EXPECT_EQ(anew[0].second, after[0].second);
    EXPECT_NE(anew[1].second, after[1].second);
}

TEST(GnnSolver, ChangesFromATickCallbackDoNoHarm) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    static btSoftBody* cloth;
    static btRigidBody* box;
    box = world.add(new btBoxShape({0.1f, 0.1f, 0.1f}), {5, 5, 5}, true);
    cloth = world.add(patch(world.info(), {0, 0, 0}));
    static int calls;
    calls = 0;
    world->setInternalTickCallback([](btDynamicsWorld*, btScalar) {
        ++calls;
        if (calls == 2) cloth->appendAnchor(3, box, true);
        if (calls == 4) {
            cloth->appendNode({0.9f, 0, 0}, 1);
            cloth->appendFace(24, 23, 25);
        }
    });
    EXPECT_NO_THROW(world.step(1.0 / 60.0, 6));
    EXPECT_EQ(solver.garmentOf(cloth)->vertex_count(), 26);
    EXPECT_EQ(solver.garmentOf(cloth)->pins(), std::vector<int>{3});
    for (const btVector3& x : positions(*cloth)) EXPECT_TRUE(std::isfinite(x.length()));
}

TEST(GnnSolver, RepinnedClothKeepsItsRestShapeAndVelocity) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5, 1 + 2));
    world.step(1.0 / 60.0, 30);
    const Points rest = solver.garmentOf(cloth)->rest().vertices;
    const btScalar speed = cloth->m_nodes[12].m_v.y();
    cloth->setMass(0, 1);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.garmentOf(cloth)->pins(), std::vector<int>{4});
    EXPECT_EQ(solver.garmentOf(cloth)->rest().vertices, rest);
    EXPECT_NEAR(cloth->m_nodes[12].m_v.y(), speed - 9.81 / 60, 1e-4);
    EXPECT_NEAR(cloth->m_nodes[0].m_v.y(), -9.81 / 60, 1e-4);
}

TEST(GnnSolver, ScaledClothGetsAScaledRestShape) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 2);
    const double edge = solver.garmentOf(cloth)->mean_edge_length();
    cloth->setRestLengthScale(1.5f);
    world.step(1.0 / 60.0);
    EXPECT_NEAR(solver.garmentOf(cloth)->mean_edge_length(), 1.5 * edge, 1e-5);
    cloth->translate({1, 0, 0});  // makes the present lengths Bullet's rest lengths
    world.step(1.0 / 60.0);
    EXPECT_NEAR(solver.garmentOf(cloth)->mean_edge_length(), edge, 1e-5);
}

TEST(GnnSolver, GivenGarmentAndStepperAreUsed) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    const Garment garment("sheet", square_mesh(4), Fabric::real_cotton(), {0, 3});
    btSoftBody* cloth = world.add(createGarmentSoftBody(world.info(), garment));
    auto log = std::make_shared<FreeFall::Log>();
    solver.attach(cloth, garment, free_fall(log));
    world.step(1.0 / 60.0, 4);
    EXPECT_EQ(log->dts.size(), 4u);
    EXPECT_EQ(solver.garmentOf(cloth)->fabric().mu, Fabric::real_cotton().mu);
    EXPECT_EQ(solver.garmentOf(cloth)->pins(), garment.pins());
    btSoftBody* other = world.add(patch(world.info(), {0, 0, 0}, 6));
    EXPECT_THROW(solver.attach(other, garment), ArgumentError);
}

TEST(GnnSolver, ClothIsAsStiffAsItsMaterialsSay) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* stiff = world.add(patch(world.info(), {0, 0, 0}));
    btSoftBody* soft = world.add(patch(world.info(), {0, 2, 0}));
    soft->m_materials[0]->m_kLST = 0;
    btSoftBody* bent = world.add(patch(world.info(), {0, 4, 0}));
    bent->m_materials[0]->m_kLST = 0.5f;
    btSoftBody::Material* bending = bent->appendMaterial();
    bending->m_kLST = 0.25f;
    bent->generateBendingConstraints(2, bending);
    world.step(1.0 / 60.0);
    const auto young = [&](const btSoftBody* body) {
        return 2.6 * solver.garmentOf(body)->fabric().mu;
    };
    EXPECT_NEAR(young(stiff), 5000, 1e-6);
    EXPECT_NEAR(young(soft), 33, 1e-6);
    EXPECT_NEAR(young(bent), (33.0 + 5000.0) / 2, 1e-6);
    EXPECT_NEAR(solver.garmentOf(stiff)->fabric().bending, 4e-6, 1e-12);
    const double edge = (40 * 0.25 + 16 * 0.25 * std::sqrt(2.0)) / 56;  // a diagonal a square
    EXPECT_NEAR(solver.garmentOf(bent)->fabric().bending, 84 * std::pow(edge, 4) * 0.5, 1e-6);
    for (const btSoftBody* body : {stiff, soft, bent})
        EXPECT_EQ(solver.garmentOf(body)->fabric().density, 0.2);
}

TEST(GnnSolver, AFabricForAllClothReplacesTheMaterials) {
    btGnnSolverSettings settings;
    settings.fabric = Fabric::soft_cotton();
    btGnnSoftBodySolver as_it_is(free_fall(), settings);
    settings.useBodyDensity = true;
    btGnnSoftBodySolver of_its_mass(free_fall(), settings);
    for (btGnnSoftBodySolver* solver : {&as_it_is, &of_its_mass}) {
        World world(solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
        cloth->setTotalMass(0.5f, true);
        world.step(1.0 / 60.0);
        const Fabric& fabric = solver->garmentOf(cloth)->fabric();
        EXPECT_EQ(fabric.mu, Fabric::soft_cotton().mu);
        EXPECT_NEAR(fabric.density, solver == &as_it_is ? Fabric::soft_cotton().density : 0.5,
                    1e-5);
    }
}

TEST(GnnSolver, EveryBodyMayHaveItsOwnFabricAndStepper) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* first = world.add(patch(world.info(), {0, 0, 0}));
    btSoftBody* second = world.add(patch(world.info(), {0, 2, 0}));
    auto log = std::make_shared<FreeFall::Log>();
    solver.attach(first, Fabric::real_cotton());
    solver.attach(second, Fabric::soft_cotton(), free_fall(log));
    world.step(1.0 / 60.0, 3);
    EXPECT_EQ(solver.garmentOf(first)->fabric().mu, Fabric::real_cotton().mu);
    EXPECT_EQ(solver.garmentOf(second)->fabric().mu, Fabric::soft_cotton().mu);
    EXPECT_EQ(log->dts.size(), 3u);
    first->setMass(0, 0);  // a new pin keeps the fabric
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.garmentOf(first)->fabric().mu, Fabric::real_cotton().mu);
}

TEST(GnnSolver, SubStepsOfOneCallAgreeWithSeparateCalls) {
    std::vector<btVector3> results[2];
    for (int i = 0; i < 2; ++i) {
        btGnnSoftBodySolver solver(free_fall());
        World world(&solver);
        btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}, 5, 1));
        if (i == 0) world->stepSimulation(1.0f / 30, 8, 1.0f / 240);
        if (i == 1) world.step(1.0 / 240.0, 8);
        results[i] = positions(*cloth);
    }
    expect_same(results[0], results[1]);
}

TEST(GnnSolver, AttachNamesBodyNodeAndRemedy) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    const auto nan = std::numeric_limits<btScalar>::quiet_NaN();
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    cloth->setUserIndex(42);
    cloth->m_nodes[7].m_x.setY(nan);
    std::string error = attach_error(solver, cloth);
    expect_contains(error, "soft body 42");
    expect_contains(error, "node 7");
    expect_contains(error, "not finite");
    expect_contains(error, "Remedy: ");
    btSoftBody* rope =
        world.add(btSoftBodyHelpers::CreateRope(world.info(), {0, 0, 0}, {1, 0, 0}, 3, 0));
    expect_contains(attach_error(solver, rope), "no faces");
    btSoftBody* ball = world.add(
        btSoftBodyHelpers::CreateEllipsoid(world.info(), {0, 1, 2}, {0.3f, 0.3f, 0.3f}, 64));
    ball->m_cfg.kPR = 5;
    expect_contains(attach_error(solver, ball), "pressure");
    EXPECT_THROW(solver.attach(nullptr), ArgumentError);
    EXPECT_THROW(btGnnSoftBodySolver(nullptr), ArgumentError);
}

TEST(GnnSolver, BodyWithNaNFromTheStartIsFrozenAndReportedUntilItIsMended) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    cloth->m_nodes[7].m_v.setX(std::numeric_limits<btScalar>::quiet_NaN());
    world.step(1.0 / 60.0, 5);
    EXPECT_EQ(solver.status().frozenBodies, 1);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    expect_contains(solver.status().messages[0].text, "node 7");
    EXPECT_EQ(node(*cloth, 0).y(), 0.0);
    cloth->m_nodes[7].m_v.setZero();
    world.step(1.0 / 60.0, 5);
    EXPECT_EQ(solver.status().clothBodies, 1);
    EXPECT_LT(node(*cloth, 0).y(), 0.0);
}

TEST(GnnSolver, NaNWrittenDuringTheRunIsPutBackAndReported) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 5);
    cloth->m_nodes[3].m_x.setZ(std::numeric_limits<btScalar>::infinity());
    cloth->addForce({std::numeric_limits<btScalar>::quiet_NaN(), 0, 0}, 5);
    world.step(1.0 / 60.0, 5);
    for (const btVector3& x : positions(*cloth)) {
        ASSERT_TRUE(std::isfinite(x.x() + x.y() + x.z()));
        EXPECT_NEAR(x.y(), -9.81 / 3600 * 55, 1e-4);
    }
    ASSERT_EQ(solver.status().messages.size(), 1u);
    expect_contains(solver.status().messages[0].text, "put back");
}

TEST(GnnSolver, UnusableClothIsSteppedByBulletAndReportedOnce) {
    btGnnSoftBodySolver solver(free_fall());
    World world(&solver);
    btSoftBody* fan = patch(world.info(), {0, 0, 0});
    fan->appendFace(0, 1, 12);
    fan->appendFace(0, 1, 13);
    world.add(fan);
    world.step(1.0 / 60.0, 10);
    EXPECT_EQ(solver.status().bulletBodies, 1);
    EXPECT_LT(node(*fan, 24).y(), -0.05);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    EXPECT_EQ(solver.status().messages[0].count, 1);
    expect_contains(solver.status().messages[0].text, "edge 0-1");
}

TEST(GnnSolver, AFactoryThatThrowsLeavesTheBodyToBullet) {
    btGnnSoftBodySolver solver([](const Garment&) -> std::unique_ptr<Stepper> {
        throw LoadError("weights.bin", "", "is missing", "train a network");
    });
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    EXPECT_NO_THROW(world.step(1.0 / 60.0, 10));
    EXPECT_LT(node(*cloth, 0).y(), -0.05);
    ASSERT_EQ(solver.status().messages.size(), 1u);
    expect_contains(solver.status().messages[0].text, "weights.bin");
}

TEST(GnnSolver, StepperThatKeepsFailingHandsTheBodyToBullet) {
    auto log = std::make_shared<FreeFall::Log>();
    log->fail_after = 5;
    btGnnSoftBodySolver solver(free_fall(log));
    World world(&solver);
    btSoftBody* cloth = world.add(patch(world.info(), {0, 0, 0}));
    world.step(1.0 / 60.0, 5);
    const double held = node(*cloth, 0).y();
    world.step(1.0 / 60.0);
    EXPECT_EQ(node(*cloth, 0).y(), held);  // a failed step leaves the cloth where it was
    world.step(1.0 / 60.0, 20);
    EXPECT_EQ(solver.status().failedSteps, 3);
    EXPECT_EQ(solver.status().bulletBodies, 1);
    EXPECT_LT(node(*cloth, 0).y(), held - 0.1);
    expect_contains(solver.status().messages.at(0).text, "free fall failed 3 times");
    log->fail_after = -1;
    solver.attach(cloth);
    world.step(1.0 / 60.0);
    EXPECT_EQ(solver.status().clothBodies, 1);
}

}  // namespace cloth::gnn_soft_body_solver_test
