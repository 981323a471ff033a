// Bullet worlds with all kinds of bodies and all kinds of calls between the steps. README.md says
// what must hold.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/fuzz/fuzz_bullet.h"
#include "tests/fuzz/fuzz_steppers.h"

namespace cloth::test {
namespace {

constexpr int kMaxTicks = 64;  // of one body in one step, whatever the time step and time scale

/// What nobody meddles with: a cloth that falls on a box, and a rope, in a collision group of their
/// own.
struct Bystanders {
    explicit Bystanders(test::World& world) {
        constexpr int kGroup = 1 << 6;
        box.reset(new btRigidBody(0, nullptr, &shape));
        box->setWorldTransform(btTransform(btQuaternion::getIdentity(), {30, -0.35f, 0}));
        world->addRigidBody(box.get(), kGroup, kGroup);
        cloth.reset(test::patch(world.info(), {30, 0, 0}, 4, 1));
        rope.reset(btSoftBodyHelpers::CreateRope(world.info(), {30, 0, 3}, {31, 0, 3}, 6, 1));
        for (btSoftBody* body : {cloth.get(), rope.get()}) world->addSoftBody(body, kGroup, kGroup);
    }
    void leave(test::World& world) {
        world->removeRigidBody(box.get());
        world->removeSoftBody(cloth.get());
        world->removeSoftBody(rope.get());
    }
    btSphereShape shape{0.3f};
    std::unique_ptr<btRigidBody> box;
    std::unique_ptr<btSoftBody> cloth, rope;
};

bool same_bits(const btSoftBody& a, const btSoftBody& b) {
    for (int i = 0; i < a.m_nodes.size(); ++i)
        if (std::memcmp(&a.m_nodes[i].m_x, &b.m_nodes[i].m_x, 3 * sizeof(btScalar)) != 0 ||
            std::memcmp(&a.m_nodes[i].m_v, &b.m_nodes[i].m_v, 3 * sizeof(btScalar)) != 0)
            return false;
    return true;
}

bool finite(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!toVec3(body.m_nodes[i].m_x).allFinite() || !toVec3(body.m_nodes[i].m_v).allFinite())
            return false;
    return true;
}

bool has_remedy(const std::string& message) {
    const auto has = [&](const char* part) { return message.find(part) != std::string::npos; };
    return (has("soft body") || has("collision shape") || has("rigid body")) && has("Remedy: ");
}

struct Side {
    explicit Side(const StepperKind& kind) : solver(kind.make), world(&solver), bystanders(world) {}
    ~Side() { bystanders.leave(world); }
    btGnnSoftBodySolver solver;
    test::World world;
    Bystanders bystanders;
};

double random_world_step(Random& random) {
    if (random.chance(0.8)) return 1.0 / 60.0;
    return random.one_of<double>({1.0 / 30.0, 1.0 / 240.0, 0.1, 1e-6, 0.0, -0.01, 3.0, 1e4});
}

/// What is wrong after a step; "" if all is well.
std::string complaint(const Side& side, const WorldMeddler& meddler, long ticks) {
    for (const btSoftBody* body : meddler.soft())
        if (side.solver.stepperOf(body) && body->isActive() && !finite(*body))
            return "cloth is not finite";
    for (const btGnnSolverMessage& message : side.solver.status().messages)
        if (!has_remedy(message.text)) return "message without place or remedy: " + message.text;
    const long bodies = static_cast<long>(meddler.soft().size()) + 1;
    return ticks > kMaxTicks * bodies ? std::to_string(ticks) + " ticks in a step" : "";
}

TEST(BulletFuzz, NothingCrashesTheWorldOrFreezesOthers) {
    for_each_seed(60, [](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        const StepperKind& kind = random.one_of(stepper_kinds());
        SCOPED_TRACE(kind.name);
        Side meddled(kind), quiet(kind);
        WorldMeddler meddler(meddled.world, meddled.solver, random);
        for (int k = random.between(1, 3); k > 0; --k) meddler.add_soft_body();
        for (int k = random.between(0, 3); k > 0; --k) meddler.add_rigid_body();
        for (int step = 0; step < 12; ++step) {
            for (int k = random.between(0, 3); k > 0; --k) meddler.meddle();
            const double h = random_world_step(random);
            const long before = meddled.solver.status().steps;
            try {
                meddled.world.step(h);
            } catch (const std::exception& error) {
                FAIL() << "stepSimulation() threw: " << error.what();
            }
            quiet.world.step(h);
            if (h == 0.0) continue;  // Bullet makes no step
            ASSERT_EQ(complaint(meddled, meddler, meddled.solver.status().steps - before), "")
                << "step " << step;
            ASSERT_TRUE(same_bits(*meddled.bystanders.cloth, *quiet.bystanders.cloth)) << step;
            ASSERT_TRUE(same_bits(*meddled.bystanders.rope, *quiet.bystanders.rope)) << step;
        }
    });
}

}  // namespace
}  // namespace cloth::test
