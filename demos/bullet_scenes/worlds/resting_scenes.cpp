#include <cmath>

#include "scenes.h"

namespace {

constexpr int kNodesAtRest = 25;

void onSphere(SceneWorld& scene) {
    scene.addRigid(new btSphereShape(0.3f), {0, 0.5f, 0})->setFriction(1);
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addSheet({0, 0.85f, 0}, 1, kNodesAtRest)->m_cfg.kDF = 1;
}

/// Two fifths of the sheet hang over the edge.
void onBoxEdge(SceneWorld& scene) {
    scene.addRigid(new btBoxShape({0.5f, 0.25f, 0.5f}), {0, 0.5f, 0})->setFriction(1);
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addSheet({0.4f, 0.78f, 0}, 1, kNodesAtRest)->m_cfg.kDF = 1;
}

void onCapsule(SceneWorld& scene) {
    btRigidBody* capsule = scene.addRigid(new btCapsuleShapeX(0.15f, 0.7f), {0, 0.6f, 0});
    capsule->setFriction(1);
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addSheet({0, 0.78f, 0}, 0.9f, kNodesAtRest)->m_cfg.kDF = 1;
}

/// A torus that lies on its side, as triangles.
void addTorus(SceneWorld& scene, const btVector3& centre) {
    constexpr int kRound = 28, kTube = 12;
    const btScalar ring = 0.28f, tube = 0.1f;
    const auto point = [&](int i, int k) {
        const btScalar a = SIMD_2_PI * static_cast<btScalar>(i % kRound) / kRound;
        const btScalar b = SIMD_2_PI * static_cast<btScalar>(k % kTube) / kTube;
        const btScalar r = ring + tube * std::cos(b);
        return btVector3(r * std::cos(a), tube * std::sin(b), -r * std::sin(a));
    };
    btTriangleMesh* triangles = scene.newTriangles();
    for (int i = 0; i < kRound; ++i)
        for (int k = 0; k < kTube; ++k) {
            triangles->addTriangle(point(i, k), point(i + 1, k), point(i + 1, k + 1));
            triangles->addTriangle(point(i, k), point(i + 1, k + 1), point(i, k + 1));
        }
    scene.addRigid(new btBvhTriangleMeshShape(triangles, true), centre)->setFriction(1);
}

void onMesh(SceneWorld& scene) {
    addTorus(scene, {0, 0.5f, 0});
    scene.addRigid(new btStaticPlaneShape({0, 1, 0}, 0), {0, 0, 0});
    scene.addSheet({0, 0.65f, 0}, 0.9f, kNodesAtRest)->m_cfg.kDF = 1;
}

}  // namespace

std::vector<SceneRecipe> restingScenes() {
    const btVector3 eye(1.3f, 1.5f, 2.0f), middle(0, 0.45f, 0);
    return {
        {"sphere", "a sheet falls on a sphere", onSphere, true, nullptr, eye, middle},
        {"box_edge", "a sheet over the edge of a box", onBoxEdge, true, nullptr, eye, middle},
        {"capsule", "a sheet over a capsule", onCapsule, true, nullptr, eye, middle},
        {"mesh", "a sheet on a body of triangles", onMesh, true, nullptr, eye, middle},
    };
}
