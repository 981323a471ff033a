// What the report of bullet_scenes is measured with, on motions whose figures are known.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "demos/bullet_scenes/scene_meters.h"
#include "demos/bullet_scenes/step_lengths.h"

namespace cloth::meters_test {

namespace {

constexpr double kTolerance = 1e-4;  // of a value: Bullet counts in floats
constexpr float kStep = 1.0f / 60;

void nothing(SceneWorld&) {
}

SceneRecipe recipe_with(OutsideWork work) {
    SceneRecipe recipe{"empty", "", nothing, false, nullptr, {0, 0, 0}, {0, 0, 0}};
    recipe.outside_work = work;
    return recipe;
}

SceneRow row_of(const SceneMeters& meters) {
    SceneRow row;
    meters.write(row);
    return row;
}

/// Sum and bounds of steps.
struct Steps {
    double sum, shortest, longest;
};
Steps measured(const std::vector<float>& steps) {
    return {std::accumulate(steps.begin(), steps.end(), 0.0),
            static_cast<double>(*std::min_element(steps.begin(), steps.end())),
            static_cast<double>(*std::max_element(steps.begin(), steps.end()))};
}

}  // namespace

TEST(TotalEnergy, OfABodyIsThatOfItsMotionAndHeight) {
    SceneWorld scene(nullptr);
    btRigidBody* box = scene.addRigid(new btBoxShape({0.5f, 0.25f, 0.25f}), {0, 2, 0}, 3);
    box->setLinearVelocity({0, 4, 0});
    box->setAngularVelocity({2, 0, 0});
    const TotalEnergy energy = TotalEnergyMeter(scene, nullptr).now();
    // The box has 0.5 m across its axis: I = m (a^2 + a^2) / 12.
    const double inertia = 3.0 * (0.5 * 0.5 + 0.5 * 0.5) / 12.0;
    EXPECT_NEAR(energy.kinetic, 0.5 * 3.0 * 16.0 + 0.5 * inertia * 4.0, kTolerance * 24.0);
    EXPECT_NEAR(energy.gravity, 3.0 * 9.81 * 2.0, kTolerance * 59.0);
    EXPECT_EQ(energy.elastic, 0.0);
}

TEST(TotalEnergy, OfClothCountsItsBulletMasses) {
    SceneWorld scene(nullptr);
    btSoftBody* sheet = scene.addSheet({0, 1, 0}, 1, 11);  // 0.2 kg
    sheet->setVelocity({3, 0, 0});
    const TotalEnergy energy = TotalEnergyMeter(scene, nullptr).now();
    EXPECT_NEAR(energy.kinetic, 0.5 * 0.2 * 9.0, kTolerance);
    EXPECT_NEAR(energy.gravity, 0.2 * 9.81, kTolerance * 2.0);
}

TEST(TotalEnergy, OfOurClothHasItsStretch) {
    const std::unique_ptr<btGnnSoftBodySolver> solver = SceneSolvers().make("quasi-newton-3");
    SceneWorld scene(solver.get());
    btSoftBody* sheet = scene.addSheet({0, 1, 0}, 1, 11);
    solver->attach(sheet);
    TotalEnergyMeter meter(scene, solver.get());
    EXPECT_NEAR(meter.now().elastic, 0.0, 1e-9);
    const double stretch = 1.1;
    for (int i = 0; i < sheet->m_nodes.size(); ++i)
        sheet->m_nodes[i].m_x.setX(static_cast<btScalar>(stretch) * sheet->m_nodes[i].m_x.x());
    // Saint Venant-Kirchhoff with the one strain g: (mu + lambda / 2) g^2 per area of 1 m^2; the
    // body weighs what the fabric's area does, times the ratio.
    const Garment& garment = *solver->garmentOf(sheet);
    const double g = (stretch * stretch - 1.0) / 2.0;
    const double ratio = 0.2 / garment.masses().sum();
    EXPECT_NEAR(meter.now().elastic,
                ratio * (garment.fabric().mu + garment.fabric().lambda / 2.0) * g * g,
                1e-3 * meter.now().elastic);
}

TEST(EnergyWatch, ABodyThatFallsGainsNothingAndOneThatIsPushedGainsItsKineticEnergy) {
    SceneWorld scene(nullptr);
    btRigidBody* ball = scene.addRigid(new btSphereShape(0.1f), {0, 100, 0}, 2);
    SceneProbe probe(scene);
    SceneMeters meters(recipe_with(OutsideWork::none), scene, probe, nullptr);
    for (int i = 0; i < 30; ++i) {
        scene.step(kStep);
        meters.step();
    }
    EXPECT_LT(row_of(meters).energy_rise_j, 1e-3);
    ball->setLinearVelocity(ball->getLinearVelocity() + btVector3(5, 0, 0));
    meters.step();
    EXPECT_NEAR(row_of(meters).energy_rise_j, 0.5 * 2.0 * 25.0, 0.01);
    EXPECT_NEAR(row_of(meters).body_speed_max, std::hypot(5.0, 9.81 * 0.5), 0.02);
}

TEST(EnergyWatch, LeavesOutWhatIsDoneFromOutside) {
    SceneWorld scene(nullptr);
    btRigidBody* ball = scene.addRigid(new btSphereShape(0.1f), {0, 100, 0}, 2);
    SceneProbe probe(scene);
    SceneMeters at_start(recipe_with(OutsideWork::at_start), scene, probe, nullptr);
    SceneMeters always(recipe_with(OutsideWork::always), scene, probe, nullptr);
    ball->setLinearVelocity({5, 0, 0});
    for (int i = 0; i < 3; ++i) {
        scene.step(kStep);
        at_start.step();
        always.step();
    }
    EXPECT_LT(row_of(at_start).energy_rise_j, 1e-3);
    EXPECT_TRUE(std::isnan(row_of(always).energy_rise_j));
}

TEST(SceneMeters, KeepTheWorstStretchAndSpeed) {
    SceneWorld scene(nullptr);
    btSoftBody* sheet = scene.addSheet({0, 1, 0}, 1, 11);
    SceneProbe probe(scene);
    SceneMeters meters(recipe_with(OutsideWork::none), scene, probe, nullptr);
    btVector3& corner = sheet->m_nodes[0].m_x;
    const btVector3 before = corner;
    corner.setX(corner.x() - 0.1f);  // as long as an edge of the mesh
    sheet->m_nodes[5].m_v = {0, 0, 7};
    meters.step();
    corner = before;
    sheet->m_nodes[5].m_v.setZero();
    meters.step();
    const SceneRow row = row_of(meters);
    EXPECT_NEAR(row.stretch_max, 2.0, 1e-4);
    EXPECT_NEAR(row.stretch_p99, 1.0, 1e-4);  // 3 of 320 links
    EXPECT_NEAR(row.node_speed_max, 7.0, 1e-6);
}

TEST(SceneMeters, WithoutClothHaveNoStretch) {
    SceneWorld scene(nullptr);
    SceneProbe probe(scene);
    SceneMeters meters(recipe_with(OutsideWork::none), scene, probe, nullptr);
    meters.step();
    EXPECT_TRUE(std::isnan(row_of(meters).stretch_max));
}

TEST(SceneProbe, ObjectsThatAreNoBodiesHaveAnInsideToo) {
    SceneWorld scene(nullptr);
    scene.addObject(new btBoxShape({1, 1, 1}), {0, 0, 0});
    scene.addSheet({0, 0.9f, 0}, 0.5f, 5);
    EXPECT_NEAR(SceneProbe(scene).deepest(), 0.1, 1e-5);
}

TEST(StepLengths, EvenOnesHaveTheRate) {
    StepPlan plan;
    plan.rate = 240;
    const std::vector<float> steps = step_lengths(plan, 2.0);
    ASSERT_EQ(steps.size(), 480u);
    EXPECT_NEAR(measured(steps).sum, 2.0, 1e-5);
}

TEST(StepLengths, RandomOnesFillTheTimeAndDependOnTheSeedAlone) {
    StepPlan plan;
    plan.random = true;
    const std::vector<float> steps = step_lengths(plan, 10.0);
    const Steps range = measured(steps);
    EXPECT_GE(range.sum, 10.0);
    EXPECT_LT(range.sum, 10.0 + 1.0 / 30.0);
    EXPECT_NEAR(range.shortest, 1.0 / 240.0, 1e-3);
    EXPECT_NEAR(range.longest, 1.0 / 30.0, 1e-3);
    EXPECT_GE(range.shortest, 1.0 / 240.0 - 1e-8);
    EXPECT_LE(range.longest, 1.0 / 30.0 + 1e-8);
    EXPECT_EQ(steps, step_lengths(plan, 10.0));
    plan.seed = 2;
    EXPECT_NE(steps, step_lengths(plan, 10.0));
}

}  // namespace cloth::meters_test
