#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "collision/self/self_tangles.h"
#include "gnn/model/make_cloth.h"
#include "tests/gnn/physics/stepper/self_contact_scenes.h"

namespace cloth::learned_self_contact_test {
namespace {

/// A network that leaves the guess as it is.
class SilentPredictor : public Predictor {
 public:
    const ModelConfig& config() const override { return m_config; }
    void predict(const ClothGraph& graph, const Features&, Points& out) override {
        out.setZero(graph.vertex_count, 3);
    }

 private:
    ModelConfig m_config = ModelConfig::variant_named("fast");
};

/// The most tangles of a frame while a folded sheet falls on the floor.
int most_tangles(double thickness) {
    const test::LayerScene scene = test::folded_sheet(200, 0.02);
    ClothStepperSettings settings = ClothStepperSettings::plain(IterationLimits::controlled());
    settings.step.potential.self_contact.thickness = thickness;
    const auto made = make_cloth(scene.garment, std::make_shared<SilentPredictor>(), settings);
    Stepper& learned = *made;
    ClothState state = scene.start;
    SelfTangles tangles(scene.garment);
    int most = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const StepReport report = learned.step(scene.boundary, 1.0 / 30.0, state);
        EXPECT_TRUE(report.finite);
        const int count = static_cast<int>(tangles.find(state.x).size());
        EXPECT_EQ(report.tangles, thickness > 0.0 ? count : 0);
        most = std::max(most, count);
    }
    return most;
}

}  // namespace

TEST(LearnedSelfContact, AreKeptApartByTheIterationsAndContactProjection) {
    EXPECT_GT(most_tangles(0.0), 20) << "the scene asks for nothing";
    EXPECT_EQ(most_tangles(4e-3), 0);
}

}  // namespace cloth::learned_self_contact_test
