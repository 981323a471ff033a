#include "scenes.h"

namespace {

/// A sheet falls on three boxes that stand on each other.
void onStack(SceneWorld& scene) {
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    for (int i = 0; i < 3; ++i)
        scene.addRigid(new btBoxShape({0.15f, 0.1f, 0.15f}),
                       {0, 0.1f + 0.2f * static_cast<btScalar>(i), 0}, 0.5f);
    scene.addSheet({0.05f, 0.75f, 0}, 0.9f, 25);
}

void pushDown(SceneWorld& scene) {
    for (btSoftBody* cloth : scene.cloth()) cloth->setVelocity({0, -1, 0});
}

/// A ball flies into a sheet that hangs from its upper edge.
void ballThrown(SceneWorld& scene) {
    const int n = 25;
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    btSoftBody* sheet =
        btSoftBodyHelpers::CreatePatch(scene.info(), {-0.5f, 1.5f, 0}, {0.5f, 1.5f, 0},
                                       {-0.5f, 0.5f, 0}, {0.5f, 0.5f, 0}, n, n, 0, true);
    scene.addCloth(sheet, 0.2f);
    for (int i = 0; i < n; i += 3) sheet->setMass(i, 0);
    btRigidBody* ball = scene.addRigid(new btSphereShape(0.12f), {0, 0.9f, 1.2f}, 0.1f);
    ball->setLinearVelocity({0, 2.0f, -3.5f});
}

void throwBall(SceneWorld& scene) {
    for (const auto& body : scene.rigid()) body->setLinearVelocity({0, 0.3f, -3});
}

/// Cloth, a rope with a weight and a ball of pressure in one world.
void mixed(SceneWorld& scene) {
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addRigid(new btSphereShape(0.25f), {-0.6f, 0.35f, 0});
    scene.addSheet({-0.6f, 0.65f, 0}, 0.8f, 21);
    btSoftBody* rope = btSoftBodyHelpers::CreateRope(scene.info(), {0.1f, 1.4f, 0}, {0.1f, 0.8f, 0},
                                                     14, /*fixed ends=*/1);
    rope->m_cfg.piterations = 8;
    rope->setTotalMass(0.5f);
    scene.addSoft(rope);
    btRigidBody* weight =
        scene.addRigid(new btBoxShape({0.06f, 0.06f, 0.06f}), {0.1f, 0.74f, 0}, 0.1f);
    rope->appendAnchor(rope->m_nodes.size() - 1, weight,
                       /*disableCollisionBetweenLinkedBodies=*/true);
    btSoftBody* ball =
        btSoftBodyHelpers::CreateEllipsoid(scene.info(), {0.7f, 0.8f, 0}, {0.2f, 0.2f, 0.2f}, 128);
    ball->m_materials[0]->m_kLST = 0.3f;
    ball->m_cfg.kPR = 2;
    ball->m_cfg.kDF = 1;
    ball->m_cfg.piterations = 4;
    ball->getCollisionShape()->setMargin(0.01f);
    ball->setTotalMass(0.3f, true);
    scene.addSoft(ball);
}

}  // namespace

std::vector<SceneRecipe> dynamicScenes() {
    return {
        {"stack",
         "a sheet falls on three loose boxes",
         onStack,
         false,
         pushDown,
         {1.3f, 1.4f, 1.9f},
         {0, 0.4f, 0}},
        {"ball",
         "a ball is thrown at a hanging sheet",
         ballThrown,
         false,
         throwBall,
         {2.4f, 1.5f, 1.8f},
         {0, 0.9f, 0}},
        {"mixed",
         "cloth, a rope with a weight and a ball of pressure",
         mixed,
         false,
         nullptr,
         {0.4f, 1.5f, 2.9f},
         {0, 0.6f, 0}},
    };
}
