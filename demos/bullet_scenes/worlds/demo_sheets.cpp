#include "demo_world.h"
#include "scenes.h"

namespace {

/// 150 kg of cloth, locked at its corners; ten bodies of 10 kg fall on it.
void cloth(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* sheet = demoSheet(scene, {0, 0, 0}, 8, 31, 1 + 2 + 4 + 8);
    sheet->getCollisionShape()->setMargin(0.5f);
    addBending(sheet, 0.4f);
    sheet->setTotalMass(150);
    scene.addClothAsItIs(sheet);

    auto* cross = new btCompoundShape;
    cross->addChildShape(btTransform::getIdentity(), scene.keepShape(new btBoxShape({4, 1, 1})));
    cross->addChildShape(btTransform(btQuaternion(SIMD_HALF_PI, 0, 0)),
                         scene.keepShape(new btCylinderShapeX({4, 1, 1})));
    btCollisionShape* const shapes[] = {cross, new btBoxShape({1, 1, 1}), new btSphereShape(1.5f)};
    for (int i = 0; i < 10; ++i)
        scene.addRigid(shapes[i % 3], {0, 2 + 6 * static_cast<btScalar>(i), 0}, 10);
}

void throwUpwards(SceneWorld& scene) {
    scene.rigid()[0]->setLinearVelocity({0, -5, 0});
}

void clothAttach(SceneWorld& scene) {
    layGround(scene);
    const int n = 9;
    btSoftBody* sheet = scene.addClothAsItIs(demoSheet(scene, {0, 6, 0}, 4, n, 4 + 8));
    btRigidBody* box = scene.addRigid(new btBoxShape({4, 1, 3}), {0, 6, -7.5f}, 20);
    sheet->appendAnchor(0, box);
    sheet->appendAnchor(n - 1, box);
}

void pushBox(SceneWorld& scene) {
    scene.rigid()[0]->setLinearVelocity({0, -3, 0});
}

void capsuleCollision(SceneWorld& scene) {
    layGround(scene);
    auto* capsule = new btCapsuleShapeX(1, 5);
    capsule->setMargin(0.5f);
    scene.addRigid(capsule, {0, 4, 0})->setFriction(0.8f);
    btSoftBody* sheet = scene.addClothAsItIs(demoSheet(scene, {0, 6, 0}, 4, 20, 0));
    sheet->setTotalMass(0.1f);
    sheet->m_cfg.piterations = sheet->m_cfg.citerations = sheet->m_cfg.diterations = 10;
}

/// A sheet falls on another one that hangs by its corners.
void collide3(SceneWorld& scene) {
    layGround(scene);
    btSoftBody* net = demoSheet(scene, {0, 0, 0}, 8, 15, 1 + 2 + 4 + 8);
    net->m_materials[0]->m_kLST = 0.4f;
    net->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    net->setTotalMass(150);
    scene.addClothAsItIs(net);
    btSoftBody* sheet = demoSheet(scene, {5, 10, 0}, 4, 7, 0);
    addBending(sheet, 0.1f);
    sheet->m_materials[0]->m_kLST = 0.5f;
    sheet->m_cfg.collisions |= btSoftBody::fCollision::VF_SS;
    sheet->setTotalMass(150);
    scene.addClothAsItIs(sheet);
}

void cutting1(SceneWorld& scene) {
    layGround(scene);
    const btScalar s = 6, h = 2;
    btSoftBody* sheet = btSoftBodyHelpers::CreatePatch(
        scene.info(), {s, h, -s}, {-s, h, -s}, {s, h, s}, {-s, h, s}, 16, 16, 1 + 2 + 4 + 8, true);
    sheet->m_cfg.piterations = 1;
    scene.addClothAsItIs(sheet);
}

void simpleCloth(SceneWorld& scene) {
    scene.setUpLikeBulletsDemos();
    scene.addRigid(new btBoxShape({50, 50, 50}), {0, -50, 0});
    btSoftBody* sheet = demoSheet(scene, {0, 5, 2}, 2, 31, 1 + 2);
    sheet->getCollisionShape()->setMargin(0.001f);
    addBending(sheet);
    sheet->setTotalMass(10);
    sheet->m_cfg.piterations = 5;
    sheet->m_cfg.kDP = 0.005f;
    scene.addClothAsItIs(sheet);
}

}  // namespace

std::vector<SceneRecipe> demoSheets() {
    const btVector3 wide(17, 10, 24), near(8, 9, 15);
    return {
        {"Cloth",
         "bodies fall on a sheet that is locked at its corners",
         cloth,
         false,
         throwUpwards,
         {21, 11, 27},
         {0, 1, 0}},
        {"ClothAttach", "a box hangs on a sheet", clothAttach, false, pushBox, wide, {0, -2, -2}},
        {"CapsuleCollision",
         "a light sheet falls on a capsule",
         capsuleCollision,
         false,
         nullptr,
         near,
         {0, 2, 0}},
        {"Collide3", "a sheet falls on a sheet", collide3, false, nullptr, wide, {1, 0, 0}},
        {"Cutting1", "a sheet, locked at its corners", cutting1, false, nullptr, wide, {0, -1, 0}},
        {"SimpleCloth",
         "a sheet, locked at two corners",
         simpleCloth,
         false,
         nullptr,
         {6, 6, 13},
         {0, 2.5f, 1}},
    };
}
