// Cloth moves as its velocities say: nothing keeps taking its motion away while gravity moves it,
// so that it would creep as in honey.

#include <gtest/gtest.h>
#include <omp.h>

#include <string>

#include "bullet_ext/softBodyGarment.h"
#include "demos/bullet_scenes/scene_solver.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/demos/bullet_scenes/print_scene.h"

namespace cloth::creep_test {

namespace {

constexpr int kRate = 60, kSteps = 6 * kRate;

/// Part of the steps in which the first cloth of a scene moved, without the velocities for it.
/// @param aside  how far its cloth starts from where the scene says (m)
double creeping_share(const SceneRecipe& recipe, double aside) {
    constexpr double kMoves = 0.02;  // m/s
    omp_set_num_threads(1);          // small sheets; other tests run beside this one
    const auto solver = SceneSolvers().make("default", defaults_of(recipe));
    SceneWorld scene(solver.get());
    recipe.build(scene);
    for (btSoftBody* sheet : scene.cloth())
        sheet->translate({static_cast<btScalar>(aside), 0, static_cast<btScalar>(0.5 * aside)});
    const btSoftBody& cloth = *scene.cloth().front();
    int creeps = 0;
    for (int step = 0; step < kSteps; ++step) {
        const Points before = nodePositions(cloth);
        scene.step(btScalar(1) / kRate);
        const double way = (nodePositions(cloth) - before).rowwise().norm().maxCoeff();
        creeps += way * kRate > kMoves && test::fastest_node(cloth) < 0.1 * way * kRate;
    }
    return static_cast<double>(creeps) / kSteps;
}

class Creep : public testing::TestWithParam<SceneRecipe> {};

std::vector<SceneRecipe> scenes() {
    std::vector<SceneRecipe> all = demoSheets();
    for (const auto& more : {restingScenes(), dynamicScenes()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

std::string name_of(const testing::TestParamInfo<SceneRecipe>& info) {
    return info.param.name;
}

}  // namespace

TEST_P(Creep, ClothMovesAsItsVelocitiesSay) {
    // Energy that a heap makes is taken while it falls together.
    const bool is_heap = GetParam().name == std::string("Cloth");
    // Loose boxes under a sheet fall otherwise for every tenth of a millimetre.
    const int starts = GetParam().name == std::string("stack") ? 8 : 1;
    double share = 0.0;
    for (int k = 0; k < starts; ++k) share += creeping_share(GetParam(), 1e-4 * k) / starts;
    EXPECT_LT(share, is_heap ? 0.2 : 0.05);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Creep, testing::ValuesIn(scenes()), name_of);

}  // namespace cloth::creep_test
