// A sheet falls on a ball in a Bullet world; the learned solver moves it.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

int main() {
    // The solver, told how to make the stepper of a piece of cloth.
    cloth::ClothSettings settings;
    settings.weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    btGnnSolverSettings soft{cloth::Fabric::soft_cotton()};  // which the network knows
    btGnnSoftBodySolver solver(
        [&](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); }, soft);

    // A Bullet world as always, but for its last argument.
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};

    btSphereShape shape(0.2f);
    btRigidBody ball(/*mass=*/0, nullptr, &shape);
    world.addRigidBody(&ball);
    btSoftBody* sheet = btSoftBodyHelpers::CreatePatch(
        world.getWorldInfo(), {-0.4f, 0.25f, -0.4f}, {0.4f, 0.25f, -0.4f}, {-0.4f, 0.25f, 0.4f},
        {0.4f, 0.25f, 0.4f}, 33, 33, /*pinned corners=*/1 + 2, /*gendiags=*/true);
    world.addSoftBody(sheet);
    for (int frame = 0; frame < 120; ++frame) world.stepSimulation(1.0f / 60, 0);

    const float middle = sheet->m_nodes[16 * 33 + 16].m_x.y(),
                edge = sheet->m_nodes[32 * 33].m_x.y();
    std::printf("after 2 s: middle of the sheet at %.3f m, a free corner at %.3f m\n",
                static_cast<double>(middle), static_cast<double>(edge));
    for (const btGnnSolverMessage& message : solver.status().messages)
        std::printf("%s\n", message.text.c_str());
    const bool learned = solver.status().clothBodies == 1 && solver.status().failedSteps == 0;
    world.removeSoftBody(sheet);
    delete sheet;
    world.removeRigidBody(&ball);
    return learned && middle > shape.getRadius() && edge < middle ? 0 : 1;
}
