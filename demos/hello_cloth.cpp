// A sheet, pinned at two corners, falls on a sphere in a Bullet world; the learned solver moves it.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

int main() {
    // The network, and how to make a stepper for a piece of cloth.
    cloth::ClothSettings settings;
    settings.weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    btGnnSoftBodySolver solver(
        [&](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); });

    // A Bullet world as always, but for its last argument.
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};
    world.getWorldInfo().m_sparsesdf.Initialize();

    btSphereShape shape(0.2f);
    btRigidBody sphere(0, nullptr, &shape);
    world.addRigidBody(&sphere);
    const float y = 0.25f;
    btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(
        world.getWorldInfo(), {-0.4f, y, -0.4f}, {0.4f, y, -0.4f}, {-0.4f, y, 0.4f},
        {0.4f, y, 0.4f}, 33, 33, /*pinned corners=*/1 + 2, /*gendiags=*/true);
    world.addSoftBody(cloth);

    std::printf("time (s)   middle (m)              free corner (m)\n");
    for (int frame = 0; frame <= 120; ++frame) {
        if (frame % 15 == 0) {
            const btVector3 a = cloth->m_nodes[16 * 33 + 16].m_x, b = cloth->m_nodes[32 * 33].m_x;
            std::printf("%5.2f   %6.3f %6.3f %6.3f   %6.3f %6.3f %6.3f\n", frame / 60.0, a.x(),
                        a.y(), a.z(), b.x(), b.y(), b.z());
        }
        world.stepSimulation(1.0f / 60, 0);
    }
    for (const btGnnSolverMessage& message : solver.status().messages)
        std::printf("%s\n", message.text.c_str());
    const bool learned = solver.status().clothBodies == 1 && solver.status().failedSteps == 0;
    const bool lies = cloth->m_nodes[16 * 33 + 16].m_x.y() > shape.getRadius();
    world.removeSoftBody(cloth);
    delete cloth;
    world.removeRigidBody(&sphere);
    return learned && lies ? 0 : 1;
}
