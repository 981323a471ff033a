// Waistbands hold: what sits on the waist is still there after a motion, without pins.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "data/body/skin_binding.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/references.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::waistband_test {

namespace {

/// Vertices of the upper 2 cm as worn.
std::vector<int> upper_edge(const Points& worn) {
    std::vector<int> edge;
    const double top = worn.col(1).maxCoeff();
    for (int i = 0; i < worn.rows(); ++i)
        if (worn(i, 1) > top - 0.02) edge.push_back(i);
    return edge;
}

}  // namespace

class Waistband : public testing::TestWithParam<std::string> {};

TEST_P(Waistband, StaysOnTheWaistWhileTheBodyJumps) {
    BodySceneSettings settings;
    settings.garment = GetParam();
    settings.motion = "01_01";
    settings.frames = 90;
    const BodyScene scene(settings);
    const Points worn = scene.start().x;
    const std::vector<int> edge = upper_edge(worn);
    const double lead_in = scene.lead_in_frames() * scene.frame_time();
    const SkinBinding waist({scene.skin(-lead_in), *scene.body().faces()}, worn(edge, Eigen::all));
    ClothState state = settle(scene, [](int, int, const std::string&) {});
    ClothStepper stepper(scene.garment(),
                         ClothStepperSettings::plain(IterationLimits::exactly(10)));
    double farthest = 0.0;
    for (int frame = 0; frame < scene.frames(); ++frame) {
        const Boundary boundary = scene.frame_boundary(frame);
        stepper.step(boundary, scene.frame_time(), state);
        ASSERT_EQ(scene.loss(boundary, state.x), "") << "frame " << frame;
        const Points places = waist.positions(scene.skin((frame + 1) * scene.frame_time()));
        const Points x = state.x(edge, Eigen::all);
        farthest = std::max(farthest, (x - places).rowwise().norm().mean());
    }
    EXPECT_LT(farthest, 0.08) << "mean way (m) that the upper edge has slid on the skin";
}

INSTANTIATE_TEST_SUITE_P(Bottoms, Waistband,
                         testing::Values("pants_1000", "shorts_1000", "skirt_1000"),
                         [](const auto& test) { return test.param; });

}  // namespace cloth::waistband_test
