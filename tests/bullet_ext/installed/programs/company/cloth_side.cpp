#include "cloth_side.h"

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

static bool falls_on_a_ball(const cloth::ClothSettings& settings) {
    btGnnSolverSettings soft{cloth::Fabric::soft_cotton()};
    btGnnSoftBodySolver solver(
        [&](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); }, soft);
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};
    btSphereShape shape(0.2f);
    btRigidBody ball(0, nullptr, &shape);
    world.addRigidBody(&ball);
    btSoftBody* sheet = btSoftBodyHelpers::CreatePatch(
        world.getWorldInfo(), {-0.4f, 0.25f, -0.4f}, {0.4f, 0.25f, -0.4f}, {-0.4f, 0.25f, 0.4f},
        {0.4f, 0.25f, 0.4f}, 17, 17, /*pinned corners=*/1 + 2, /*gendiags=*/true);
    world.addSoftBody(sheet);
    for (int frame = 0; frame < 60; ++frame) world.stepSimulation(1.0f / 60, 0);
    const float middle = sheet->m_nodes[8 * 17 + 8].m_x.y(),
                corner = sheet->m_nodes[16 * 17].m_x.y();
    const bool stepped = solver.status().clothBodies == 1 && solver.status().failedSteps == 0;
    std::printf("the middle at %.3f m, a corner at %.3f m\n", static_cast<double>(middle),
                static_cast<double>(corner));
    world.removeSoftBody(sheet);
    delete sheet;
    world.removeRigidBody(&ball);
    return stepped && middle > shape.getRadius() && corner < middle;
}

bool cloth_falls_on_a_ball() {
    cloth::ClothSettings settings;
    const bool physics = falls_on_a_ball(settings);
    settings.weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    const bool learned = falls_on_a_ball(settings);
    try {  // also from a shared library
        cloth::Weights::load("/there/is/none");
        return false;
    } catch (const cloth::LoadError&) {
        return physics && learned;
    }
}
