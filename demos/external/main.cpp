// A Bullet program of another project: its sheet is moved by the learned solver of an installed
// FastCloth. The weights come with the installation.

#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

int main() {
    const std::string file = cloth::asset_path("weights/small.safetensors");
    cloth::ClothSettings settings;
    settings.weights = std::make_shared<const cloth::EngineWeights>(cloth::Weights::load(file));
    btGnnSolverSettings soft{cloth::Fabric::soft_cotton()};  // which the network knows
    btGnnSoftBodySolver solver(
        [&](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); }, soft);
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};
    btSoftBody* sheet =
        btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-0.4f, 1, -0.4f}, {0.4f, 1, -0.4f},
                                       {-0.4f, 1, 0.4f}, {0.4f, 1, 0.4f}, 11, 11, 1 + 2, true);
    world.addSoftBody(sheet);
    for (int step = 0; step < 30; ++step) world.stepSimulation(1.0f / 60, 0);
    const float height = sheet->m_nodes[10 * 11 + 5].m_x.y();
    const bool learned = solver.status().clothBodies == 1 && solver.status().failedSteps == 0;
    std::printf("weights %s\nfree edge at %.3f m after half a second\n", file.c_str(),
                static_cast<double>(height));
    world.removeSoftBody(sheet);
    delete sheet;
    return learned && height < 0.9f && height > 0 ? 0 : 1;
}
