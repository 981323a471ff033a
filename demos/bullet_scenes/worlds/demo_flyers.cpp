#include "demo_world.h"
#include "scenes.h"

namespace {

/// Fifty sheets glide to the ground.
void aero(SceneWorld& scene) {
    layGround(scene);
    DemoRandom random(1);
    for (int i = 0; i < 50; ++i) {
        btSoftBody* sheet = demoSheet(scene, {0, 10, 0}, 2, 6, 0);
        addBending(sheet);
        sheet->m_cfg.kLF = 0.004f;
        sheet->m_cfg.kDG = 0.0003f;
        sheet->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSided;
        const btVector3 turn = 0.1f * random.direction();
        const btVector3 place = 15 * random.direction() + btVector3(0, 20, 80);
        btQuaternion rotation;
        rotation.setEuler(SIMD_PI / 8 + turn.x(), -SIMD_PI / 7 + turn.y(), turn.z());
        sheet->transform(btTransform(rotation, place));
        sheet->setTotalMass(0.1f);
        sheet->addForce({0, 2, 0}, 0);
        scene.addClothAsItIs(sheet);
    }
}

/// Five banners in the wind.
void aero2(SceneWorld& scene) {
    layGround(scene);
    const btScalar s = 5, gap = 0.5f;
    const int segments = 10;
    for (int i = 0; i < 5; ++i) {
        btSoftBody* banner = btSoftBodyHelpers::CreatePatch(scene.info(), {-s, 0, -3 * s},
                                                            {s, 0, -3 * s}, {-s, 0, s}, {s, 0, s},
                                                            segments, 3 * segments, 1 + 2, true);
        banner->getCollisionShape()->setMargin(0.5f);
        addBending(banner, 0.0004f);
        banner->m_cfg.kLF = 0.05f;
        banner->m_cfg.kDG = 0.01f;
        banner->m_cfg.piterations = 2;
        banner->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSidedLiftDrag;
        banner->setWindVelocity({4, -12, -25});
        const btScalar x = -s * segments + static_cast<btScalar>(i + 1) * (2 * s + gap);
        banner->transform(btTransform(btQuaternion({1, 0, 0}, SIMD_HALF_PI), {x, 0, 0}));
        banner->setTotalMass(2);
        btSoftBodyHelpers::ReoptimizeLinkOrder(banner);
        scene.addClothAsItIs(banner);
    }
}

}  // namespace

std::vector<SceneRecipe> demoFlyers() {
    return {
        {"Aero",
         "fifty sheets glide to the ground",
         aero,
         false,
         nullptr,
         {45, 30, 125},
         {0, 14, 80},
         OutsideWork::at_start},
        {"Aero2",
         "five banners in the wind",
         aero2,
         false,
         nullptr,
         {-10, 12, 72},
         {-18, 2, -4},
         OutsideWork::always},
    };
}
