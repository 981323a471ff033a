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
    int most = 0;    ///< edges in the worst frame
    int calm = 0;    ///< in the last one
    int frames = 0;  ///< in which any is
};

Tangled run(const StepSettings& step) {
    const HardSceneParts parts = fast_cape();
    ClothStepperSettings settings;
    settings.step = step;
    settings.step.potential.self_contact = parts.self_contact;
    ClothStepper stepper(parts.garment, settings);
    ClothState state = parts.start;
    SelfTangles tangles(parts.garment);
    Tangled result;
    for (int frame = 0; frame < moving + calm; ++frame) {
        const double t0 = std::min(frame, moving) * parts.dt;
        const double t1 = std::min(frame + 1, moving) * parts.dt;
        EXPECT_TRUE(stepper.step(parts.outside(t0, t1), parts.dt, state).finite);
        result.calm = static_cast<int>(tangles.find(state.x).size());
        result.most = std::max(result.most, result.calm);
        result.frames += result.calm > 0;
    }
    return result;
}

}  // namespace

TEST(FastCape, IsHardlyEverTangledAndNotWhenTheCharacterStandsStill) {
    std::vector<StepSettings> variants = {StepSettings()};  // Newton's method, as it is stiff
    for (const int iterations : {2, 3, 4})
        variants.push_back(StepSettings::in_small_steps(120.0, iterations));
    std::vector<int> frames;
    for (size_t k = 0; k < variants.size(); ++k) {
        const Tangled tangled = run(variants[k]);
        EXPECT_EQ(tangled.calm, 0) << k;
        EXPECT_LE(tangled.most, 40) << k;
        EXPECT_LE(tangled.frames, 30) << k;
        frames.push_back(tangled.frames);
    }
    // How long a tangle stays is chance: one run of ten has one for a second.
    std::sort(frames.begin(), frames.end());
    EXPECT_LE(frames[2], 5);
}

}  // namespace cloth::fast_cape_test
