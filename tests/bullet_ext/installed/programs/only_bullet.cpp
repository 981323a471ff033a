// A Bullet program with a cloth solver of its own: needs FastCloth::bullet, Bullet and Eigen.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "bullet_ext/btGnnSoftBodySolver.h"

/// Cloth in free fall.
class Falling : public cloth::Stepper {
 public:
    std::string name() const override { return "falling"; }
    cloth::StepReport step(const cloth::Boundary& boundary, double dt,
                           cloth::ClothState& state) override {
        state.v.rowwise() += dt * boundary.gravity.transpose();
        state.x += dt * state.v;
        state.time += dt;
        return {};
    }
};

int main() {
    btGnnSoftBodySolver solver([](const cloth::Garment&) { return std::make_unique<Falling>(); });
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -10, 0};
    btSoftBody* sheet = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {0, 1, 0}, {1, 1, 0},
                                                       {0, 1, 1}, {1, 1, 1}, 5, 5, 0, true);
    world.addSoftBody(sheet);
    for (int step = 0; step < 30; ++step) world.stepSimulation(1.0f / 60, 0);
    const float y = sheet->m_nodes[12].m_x.y();
    world.removeSoftBody(sheet);
    delete sheet;
    return y < 0 && y > -1 ? 0 : 1;  // fell 1.29 m in half a second, in steps
}
