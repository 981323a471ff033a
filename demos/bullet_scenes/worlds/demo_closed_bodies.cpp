#include "closed_meshes.h"
#include "demo_world.h"
#include "scenes.h"

namespace {

/// Angles about x, y and z (rad).
btTransform turned(const btVector3& angles, const btVector3& place) {
    btMatrix3x3 rotation;
    rotation.setEulerZYX(angles.x(), angles.y(), angles.z());
    return btTransform(rotation, place);
}

/// The demos scale after they have moved the body: its place is scaled with it.
void finish(btSoftBody* body, const btTransform& pose, btScalar size, btScalar mass) {
    shuffleLinks(body);
    body->transform(pose);
    body->scale({size, size, size});
    body->setTotalMass(mass, true);
}

btSoftBody* demoTorus(SceneWorld& scene) {
    btSoftBody* torus = createTorus(scene.info());
    torus->generateBendingConstraints(2);
    torus->m_cfg.piterations = 2;
    return torus;
}

btSoftBody* demoHare(SceneWorld& scene) {
    btSoftBody* hare = createHare(scene.info());
    addBending(hare, 0.5f);
    hare->m_cfg.piterations = 2;
    hare->m_cfg.kDF = 0.5f;
    return hare;
}

void collide(SceneWorld& scene) {
    layGround(scene);
    for (int i = 0; i < 3; ++i) {
        btSoftBody* body = demoTorus(scene);
        body->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
        const btScalar odd = static_cast<btScalar>(i & 1), x = 3 * static_cast<btScalar>(i);
        finish(body, turned({SIMD_HALF_PI * (1 - odd), SIMD_HALF_PI * odd, 0}, {x, 2, 0}), 2, 50);
        scene.addClothAsItIs(body);
    }
}

void collide2(SceneWorld& scene) {
    layGround(scene);
    for (int i = 0; i < 3; ++i) {
        btSoftBody* body = demoHare(scene);
        body->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
        const btScalar odd = static_cast<btScalar>(i & 1), y = -1 + 5 * static_cast<btScalar>(i);
        finish(body, turned({0, SIMD_HALF_PI * odd, 0}, {0, y, 0}), 6, 100);
        scene.addClothAsItIs(body);
    }
}

/// Twenty hollow boxes slide, each with another friction.
void friction(SceneWorld& scene) {
    layGround(scene);
    constexpr int kBoxes = 20;
    const btScalar side = 2, apart = side + side / 4;
    for (int i = 0; i < kBoxes; ++i) {
        const btVector3 centre((static_cast<btScalar>(i) - kBoxes / 2) * apart, -10 + side, 40);
        btVector3 corners[8];
        for (int c = 0; c < 8; ++c)
            corners[c] =
                centre + (side / 2) * btVector3(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
        btSoftBody* box = btSoftBodyHelpers::CreateFromConvexHull(scene.info(), corners, 8, false);
        shuffleLinks(box);
        box->generateBendingConstraints(2);
        box->m_cfg.kDF = 0.1f * static_cast<btScalar>(i + 1) / kBoxes;
        box->addVelocity({0, 0, -10});
        scene.addClothAsItIs(box);
    }
}

void torus(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* body = demoTorus(scene);
    finish(body, turned({SIMD_HALF_PI, 0, 0}, {0, 4, 0}), 2, 50);
    scene.addClothAsItIs(body);
}

/// With pose matching.
void torusMatch(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* body = createTorus(scene.info());
    body->m_materials[0]->m_kLST = 0.1f;
    body->m_cfg.kMT = 0.05f;
    finish(body, turned({SIMD_HALF_PI, 0, 0}, {0, 4, 0}), 2, 50);
    body->setPose(false, true);
    scene.addSoft(body);
}

void bunny(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* body = demoHare(scene);
    finish(body, btTransform::getIdentity(), 6, 100);
    scene.addClothAsItIs(body);
}

void bunnyMatch(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* body = createHare(scene.info());
    body->m_cfg.kDF = 0.5f;
    body->m_cfg.kMT = 0.05f;
    body->m_cfg.piterations = 5;
    finish(body, btTransform::getIdentity(), 6, 100);
    body->setPose(false, true);
    scene.addSoft(body);
}

/// The stair and the plate on which the balls of Pressure and Volume fall.
void layStair(SceneWorld& scene) {
    scene.addRigid(new btBoxShape({5, 1, 5}), {0, 4, 0.5f}, 15)->setFriction(1);
    btCollisionShape* stair = scene.keepShape(new btBoxShape({2, 1, 5}));
    for (int i = 0; i < 10; ++i) {
        const btScalar k = 2 * static_cast<btScalar>(i);
        scene.addRigid(stair, {2 * k, k, 0})->setFriction(1);
    }
}

btSoftBody* demoBall(SceneWorld& scene) {
    return createBall(scene.info(), {35, 25, 0}, 3, 512);
}

void pressure(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* ball = demoBall(scene);
    ball->m_materials[0]->m_kLST = 0.1f;
    ball->m_cfg.kDF = 1;
    ball->m_cfg.kDP = 0.001f;
    ball->m_cfg.kPR = 2500;
    ball->setTotalMass(30, true);
    scene.addSoft(ball);
    layStair(scene);
}

void volume(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* ball = demoBall(scene);
    ball->m_materials[0]->m_kLST = 0.45f;
    ball->m_cfg.kVC = 20;
    ball->setTotalMass(50, true);
    ball->setPose(true, false);
    scene.addSoft(ball);
    layStair(scene);
}

}  // namespace

std::vector<SceneRecipe> demoClosedBodies() {
    const btVector3 eye(14, 6, 26), middle(0, -3, 0);
    const btVector3 high(30, 22, 60), stair(18, 6, 0);
    return {
        {"Collide", "three tori fall", collide, false, nullptr, {22, 8, 30}, {6, -3, 0}},
        {"Collide2", "three hares fall", collide2, false, nullptr, {45, 25, 95}, {0, 20, 0}},
        {"Friction",
         "twenty hollow boxes slide",
         friction,
         false,
         nullptr,
         {42, 22, 88},
         {0, -10, 15}},
        {"Torus", "a torus falls", torus, false, nullptr, eye, middle},
        {"TorusMatch", "a torus that matches a pose falls", torusMatch, false, nullptr, eye,
         middle},
        {"Bunny", "a hare falls", bunny, false, nullptr, eye, middle},
        {"BunnyMatch", "a hare that matches a pose falls", bunnyMatch, false, nullptr, eye, middle},
        {"Pressure", "a ball of pressure on a stair", pressure, false, nullptr, high, stair},
        {"Volume", "a ball that keeps its volume on a stair", volume, false, nullptr, high, stair},
    };
}
