// The cape of the hard case, as long as the character darts about and when it stands still again.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collision/self/self_tangles.h"
#include "demos/hard_cases/case_scenes.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::fast_cape_test {
namespace {

constexpr int moving = 120, calm = 60;  // frames

struct Tangled {
    int most = 0;     ///< edges in the worst frame
    int calm = 0;     ///< in the last one
    int frames = 0;   ///< in which any is
    int longest = 0;  ///< of these, one after the other
};

/// By so many iterations in small steps, as soft cloth takes three. By Newton's method, the default
/// of so stiff a cape, fewer edges are tangled, but a few may stay so: not every tangle can be
/// undone.
Tangled run(int untangling_moves, int iterations = 3) {
    const HardSceneParts parts = fast_cape();
    ClothStepperSettings settings;
    settings.step = StepSettings::in_small_steps(120.0, iterations);
    settings.step.potential.self_contact = parts.self_contact;
    settings.step.potential.self_contact.untangling_moves = untangling_moves;
    ClothStepper stepper(parts.garment, settings);
    ClothState state = parts.start;
    SelfTangles tangles(parts.garment);
    Tangled result;
    int in_a_row = 0;
    for (int frame = 0; frame < moving + calm; ++frame) {
        const double t0 = std::min(frame, moving) * parts.dt;
        const double t1 = std::min(frame + 1, moving) * parts.dt;
        EXPECT_TRUE(stepper.step(parts.outside(t0, t1), parts.dt, state).finite);
        result.calm = static_cast<int>(tangles.find(state.x).size());
        result.most = std::max(result.most, result.calm);
        result.frames += result.calm > 0;
        in_a_row = result.calm > 0 ? in_a_row + 1 : 0;
        result.longest = std::max(result.longest, in_a_row);
    }
    ::testing::Test::RecordProperty("most_" + std::to_string(untangling_moves), result.most);
    ::testing::Test::RecordProperty("calm_" + std::to_string(untangling_moves), result.calm);
    ::testing::Test::RecordProperty("frames_" + std::to_string(untangling_moves), result.frames);
    return result;
}

}  // namespace

TEST(FastCape, IsUntangledWhenTheCharacterStandsStill) {
    // How long a tangle stays is chance: one of several runs has a long one now and then.
    std::vector<Tangled> with;
    for (const int iterations : {2, 3, 4}) {
        with.push_back(run(SelfContactSettings().untangling_moves, iterations));
        EXPECT_EQ(with.back().calm, 0) << iterations;
        EXPECT_LE(with.back().most, 40) << iterations;
    }
    std::sort(with.begin(), with.end(),
              [](const Tangled& a, const Tangled& b) { return a.longest < b.longest; });
    EXPECT_LE(with[1].longest, 10);
    // By rounding, the other run is tangled in 14 to 123 of its frames, or more.
    const Tangled without = run(0);
    EXPECT_GT(without.frames, 0) << "the scene asks for nothing";
    EXPECT_LT(with[1].frames, without.frames);
}

}  // namespace cloth::fast_cape_test
