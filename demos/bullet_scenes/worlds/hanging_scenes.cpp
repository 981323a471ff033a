#include <cmath>

#include "scenes.h"

namespace {

constexpr int kNodes = 21;

void hanging(SceneWorld& scene) {
    scene.addSheet({0, 1.5f, 0}, 1, kNodes, 1 + 2);
}

/// One edge is anchored to a box that goes to and fro and turns.
void attached(SceneWorld& scene) {
    btRigidBody* box = scene.addRigid(new btBoxShape({0.5f, 0.05f, 0.05f}), {0, 1.5f, -0.55f}, 0,
                                      /*kinematic=*/true);
    btSoftBody* sheet = scene.addSheet({0, 1.5f, 0}, 1, kNodes);
    for (int i = 0; i < kNodes; i += 2)
        sheet->appendAnchor(i, box, /*disableCollisionBetweenLinkedBodies=*/true);
    scene.drive = [box](btScalar time) {
        const btScalar motion = time < 6 ? std::sin(SIMD_PI * time / 1.5f) : 0;
        box->setWorldTransform(
            btTransform(btQuaternion({0, 1, 0}, 0.4f * motion), {0.3f * motion, 1.5f, -0.55f}));
    };
}

/// One edge is fixed to a pole; the wind blows along the cloth and a little across.
void flag(SceneWorld& scene) {
    scene.addRigid(new btCapsuleShape(0.02f, 1.8f), {-0.53f, 1, 0});
    btSoftBody* cloth =
        btSoftBodyHelpers::CreatePatch(scene.info(), {-0.5f, 1.8f, 0}, {0.5f, 1.8f, 0},
                                       {-0.5f, 1.2f, 0}, {0.5f, 1.2f, 0}, kNodes, 13, 0, true);
    scene.addCloth(cloth, 0.12f);
    for (int k = 0; k < 13; ++k) cloth->setMass(k * kNodes, 0);
    cloth->m_cfg.aeromodel = btSoftBody::eAeroModel::F_TwoSidedLiftDrag;
    cloth->m_cfg.kDG = 0.05f;
    cloth->m_cfg.kLF = 0.02f;
    cloth->setWindVelocity({9, 0, 1.2f});
}

}  // namespace

std::vector<SceneRecipe> hangingScenes() {
    const btVector3 eye(1.4f, 1.9f, 2.8f), middle(0, 1.0f, 0);
    return {
        {"hanging", "a sheet, pinned at two corners", hanging, true, nullptr, eye, middle},
        {"attached", "a sheet, anchored to a box that moves", attached, true, nullptr, eye, middle,
         OutsideWork::always},
        {"flag",
         "a flag in the wind",
         flag,
         false,
         nullptr,
         {0.6f, 1.6f, 2.9f},
         {0, 1.2f, 0},
         OutsideWork::always},
    };
}
