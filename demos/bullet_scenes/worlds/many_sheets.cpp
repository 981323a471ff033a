#include "scenes.h"

namespace {

constexpr int kSheets = 20;  // of 441 nodes
constexpr int kNodesOfEach = 21;

/// Of each sheet 15 cm hang down around the table, or lie around the sphere.
void drapes(SceneWorld& scene) {
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    btCollisionShape* const sphere = scene.keepShape(new btSphereShape(0.3f));
    btCollisionShape* const table = scene.keepShape(new btBoxShape({0.25f, 0.2f, 0.25f}));
    for (int k = 0; k < kSheets; ++k) {
        const btVector3 place(1.2f * static_cast<btScalar>(k % 5 - 2), 0.5f,
                              1.2f * static_cast<btScalar>(k / 5));
        scene.addRigid(k % 2 == 0 ? sphere : table, place)->setFriction(1);
        scene.addSheet(place + btVector3(0, 0.35f, 0), 0.8f, kNodesOfEach)->m_cfg.kDF = 1;
    }
}

/// Five sheets that touch each other, each turned against the one below it.
void layers(SceneWorld& scene) {
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addRigid(new btBoxShape({0.25f, 0.2f, 0.25f}), {0, 0.5f, 0})->setFriction(1);
    for (int k = 0; k < 5; ++k) {
        const auto level = static_cast<btScalar>(k);
        btSoftBody* const sheet = scene.addSheet({0, 0, 0}, 0.8f, kNodesOfEach);
        sheet->rotate(btQuaternion({0, 1, 0}, 0.25f * level));
        sheet->translate({0, 0.72f + 0.05f * level, 0});
        sheet->m_cfg.kDF = 0.5f;
        sheet->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    }
}

}  // namespace

std::vector<SceneRecipe> manySheets() {
    return {{"drapes",
             "twenty sheets fall on spheres and tables",
             drapes,
             false,
             nullptr,
             {4.5f, 4, 7},
             {0, 0, 1.5f}},
            {"layers",
             "five sheets fall on a table, one on another",
             layers,
             false,
             nullptr,
             {1.5f, 1.5f, 2.2f},
             {0, 0.4f, 0}}};
}
