// A person walks and jumps in a Bullet world, wearing a T-shirt that the learned solver moves.
//
//     hello_tshirt [MOTION] [FRAMES]      01_01 and 60 if not given
//
// No LibTorch: this is what a game would carry.
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/garmentSoftBody.h"
#include "data/body/animated_body.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "gnn/model/make_cloth.h"

namespace {

int frames_named(const char* text) {
    char* end = nullptr;
    const long frames = std::strtol(text, &end, 10);
    if (end == text || *end != '\0' || frames < 1 || frames > 100000)
        throw cloth::ArgumentError(std::string("FRAMES ") + text, "is no number of frames",
                                   "give a whole number from 1 to 100000");
    return static_cast<int>(frames);
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string motion = argc > 1 ? argv[1] : "01_01";
    const int frames = argc > 2 ? frames_named(argv[2]) : 60;
    const cloth::AnimatedBody person(
        std::make_shared<const cloth::Body>(cloth::Body::load_default()),
        cloth::load_motion_by_name(motion));
    const cloth::Garment shirt("tshirt", cloth::load_mesh(cloth::asset_path("garments/tshirt.obj")),
                               cloth::Fabric::soft_cotton());
    cloth::ClothSettings settings;
    settings.weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    btGnnSoftBodySolver solver(
        [&](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); });

    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};
    world.getWorldInfo().m_sparsesdf.Initialize();

    // The person's skin replaces the shape of this object before every step.
    btSphereShape anywhere(1.0f);
    btRigidBody skin(0, nullptr, &anywhere);
    skin.setFriction(0.5f);
    world.addRigidBody(&skin);
    btSoftBody* cloth = cloth::createGarmentSoftBody(world.getWorldInfo(), shirt);
    world.addSoftBody(cloth);
    solver.attach(cloth, shirt);

    constexpr double dt = 1.0 / 30.0;
    double ms = 0.0, deepest = 0.0;
    const int lead_in = static_cast<int>(person.settings().lead_in / dt + 0.5);
    for (int frame = 0; frame < lead_in + frames; ++frame) {
        solver.setAnimatedObstacle(&skin, person.faces(), person.vertices(frame * dt),
                                   person.vertices((frame + 1) * dt), dt, person.limbs());
        world.stepSimulation(static_cast<btScalar>(dt), 0);
        ms += solver.status().times.total();
        deepest = std::max(deepest, solver.status().maxPenetration);
    }
    btVector3 low, high;
    cloth->getAabb(low, high);
    std::printf(
        "%d frames, %.1f ms each, shirt from %.2f to %.2f m, deepest vertex %.2f mm inside\n",
        lead_in + frames, ms / (lead_in + frames), low.y(), high.y(), 1e3 * deepest);
    for (const btGnnSolverMessage& message : solver.status().messages)
        std::printf("%s\n", message.text.c_str());
    std::printf("%ld of %ld steps were cut into parts\n", solver.status().cutSteps,
                solver.status().steps);
    const bool worn = solver.status().failedSteps == 0 && low.y() > 0.6f && high.y() < 2.2f;
    world.removeSoftBody(cloth);
    delete cloth;
    world.removeRigidBody(&skin);
    return worn ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "hello_tshirt: %s\n", error.what());
    return 2;
}
