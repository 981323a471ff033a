#include "demo_world.h"

void layGround(SceneWorld& scene) {
    scene.setUpLikeBulletsDemos();
    scene.addObject(new btBoxShape({100, 1.5f, 100}), {0, -12, 0});
}

btSoftBody* demoSheet(SceneWorld& scene, const btVector3& centre, btScalar half, int n,
                      int corners) {
    return btSoftBodyHelpers::CreatePatch(
        scene.info(), centre + btVector3(-half, 0, -half), centre + btVector3(half, 0, -half),
        centre + btVector3(-half, 0, half), centre + btVector3(half, 0, half), n, n, corners, true);
}

void addBending(btSoftBody* body, btScalar stiffness) {
    btSoftBody::Material* material = body->appendMaterial();
    material->m_kLST = stiffness;
    body->generateBendingConstraints(2, material);
}

void shuffleLinks(btSoftBody* body) {
    DemoRandom random(1);
    for (int l = body->m_links.size() - 1; l > 0; --l) body->m_links.swap(l, random.below(l + 1));
}

btScalar DemoRandom::between(btScalar low, btScalar high) {
    m_state = 1664525u * m_state + 1013904223u;
    return low + (high - low) * static_cast<btScalar>(m_state >> 8) / (1 << 24);
}

int DemoRandom::below(int count) {
    return static_cast<int>(between(0, 1) * static_cast<btScalar>(count)) % count;
}

btVector3 DemoRandom::direction() {
    const btScalar x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return btVector3(x, y, z).normalized();
}
