// Steps with all kinds of surroundings, states and time steps. README.md says what must hold.

#include <gtest/gtest.h>
#include <omp.h>

#include "tests/fuzz/fuzz_boundaries.h"
#include "tests/fuzz/fuzz_meshes.h"
#include "tests/fuzz/fuzz_steppers.h"

namespace cloth::test {
namespace {

struct Scene {
    const Garment& garment;
    std::vector<Boundary> boundaries;  ///< one each frame
    ClothState state;
    double dt;
};

Scene random_scene(const Garment& garment, Random& random, int frames) {
    Scene scene{garment, {}, random_state(garment, random), random_time_step(random)};
    for (int k = 0; k < frames; ++k) scene.boundaries.push_back(random_boundary(garment, random));
    return scene;
}

/// The state after all frames; what is wrong goes to `problem`.
ClothState run(Stepper& stepper, const Scene& scene, std::string& problem) {
    ClothState state = scene.state;
    for (const Boundary& boundary : scene.boundaries)
        if (problem.empty())
            problem = checked_step(stepper, scene.garment, boundary, scene.dt, state);
    return state;
}

ClothState run_anew(const StepperKind& kind, const Scene& scene) {
    std::string problem;
    const std::unique_ptr<Stepper> stepper = kind.make(scene.garment);
    ClothState state = run(*stepper, scene, problem);
    EXPECT_EQ(problem, "");
    return state;
}

/// A garment that falls on a ball beside it: a scene without any defect.
Scene plain_scene(const Garment& garment) {
    Boundary boundary;
    boundary.pin_targets.resize(static_cast<Eigen::Index>(garment.pins().size()), 3);
    for (size_t k = 0; k < garment.pins().size(); ++k)
        boundary.pin_targets.row(static_cast<Eigen::Index>(k)) =
            garment.rest().vertices.row(garment.pins()[k]);
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.radius = 0.1;
    ball.pose0.translation() = ball.pose1.translation() = Vec3(0.1, -0.101, 0.12);
    boundary.obstacles = {ball};
    return {garment, {boundary, boundary}, ClothState::at_rest(garment), 1.0 / 30.0};
}

Garment random_sheet(Random& random) {
    std::vector<int> pins;
    for (int i = 0; i < 36; ++i)
        if (random.chance(0.1)) pins.push_back(i);
    const Fabric fabric = random.chance(0.5) ? Fabric::soft_cotton() : Fabric::real_cotton();
    return Garment("sheet", plain_sheet(6), fabric, pins);
}

TEST(BoundariesFuzz, StepsAreFiniteOrRefusedAndRepeatable) {
    for_each_seed(80, [](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        const Garment garment = random_sheet(random);
        const Scene scene = random_scene(garment, random, 2), plain = plain_scene(garment);
        for (const StepperKind& kind : stepper_kinds()) {
            SCOPED_TRACE(kind.name);
            const std::unique_ptr<Stepper> stepper = kind.make(garment);
            std::string problem;
            const ClothState first = run(*stepper, scene, problem);
            ASSERT_EQ(problem, "");
            ASSERT_TRUE(same_bits(first, run_anew(kind, scene))) << "another of the same";
            const ClothState after = run(*stepper, plain, problem);
            ASSERT_EQ(problem, "");
            ASSERT_TRUE(same_bits(after, run_anew(kind, plain)))
                << "what was before must not matter";
        }
    });
}

TEST(BoundariesFuzz, TheNumberOfThreadsDoesNotMatter) {
    const Garment garment("sheet", plain_sheet(24), Fabric::soft_cotton(), {0, 23});
    const int usual = omp_get_max_threads();
    for_each_seed(4, [&](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        const Scene scene = random_scene(garment, random, 1);
        for (const StepperKind& kind : stepper_kinds()) {
            SCOPED_TRACE(kind.name);
            omp_set_num_threads(1);
            const ClothState one = run_anew(kind, scene);
            omp_set_num_threads(2);
            EXPECT_TRUE(same_bits(one, run_anew(kind, scene)));
        }
    });
    omp_set_num_threads(usual);
}

}  // namespace
}  // namespace cloth::test
