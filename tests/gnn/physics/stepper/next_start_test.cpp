#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::next_start_test {
namespace {

/// A corner of a hanging sheet is pulled: 10 mm, and then a little farther.
class NextStart : public ::testing::Test {
 protected:
    struct Taken {
        StepReport report;
        ClothState state;
    };
    Taken pull(Stepper& stepper, double up, double dt = 1.0 / 30.0, double falls = 0.0) const {
        Boundary boundary;
        ClothState state = ClothState::at_rest(m_garment);
        state.v.col(1).array() -= falls;
        boundary.pin_targets = state.x.topRows(1);
        boundary.pin_targets(0, 1) += up;
        const StepReport report = stepper.step(boundary, dt, state);
        return {report, state};
    }
    static ClothStepperSettings accurate() {
        IterationLimits limits = IterationLimits::exactly(200);
        limits.least_iterations = 1;
        limits.tolerance = 1e-3;
        return ClothStepperSettings::plain(limits);
    }
    const Garment m_garment{"sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton(), {0}};
};

TEST_F(NextStart, NearTheEndSavesIterationsAndLeadsToTheSame) {
    ClothStepper stepper(m_garment, accurate());
    const Taken first = pull(stepper, 0.010), cold = pull(stepper, 0.0101);
    EXPECT_TRUE(stepper.start_next_at(first.state.x));
    const Taken warm = pull(stepper, 0.0101);
    EXPECT_LE(warm.report.residual.value(), 1e-3);
    EXPECT_LT(2 * warm.report.iterations, cold.report.iterations);
    EXPECT_LT((warm.state.x - cold.state.x).rowwise().norm().maxCoeff(), 1e-4);
    EXPECT_EQ(pull(stepper, 0.0101).state.x, cold.state.x) << "it is that of one step";
}

TEST_F(NextStart, IsLeftWhereItIsWorseOrFitsNoStep) {
    ClothStepper stepper(m_garment, accurate());
    const ClothState usual = pull(stepper, 0.010).state;
    const Points far = usual.x.array() + 10.0, none = Points(3, 3),
                 nowhere =
                     Points::Constant(usual.x.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    for (const Points& x : {far, none, nowhere}) {
        stepper.start_next_at(x);
        const Taken taken = pull(stepper, 0.010);
        EXPECT_FALSE(taken.report.prediction_rejected) << "nothing was predicted";
        EXPECT_EQ(taken.state.x, usual.x);
    }
    stepper.start_next_at(usual.x);
    EXPECT_FALSE(pull(stepper, 0.010, -1.0).report.finite);
    EXPECT_EQ(pull(stepper, 0.010).state.x, usual.x) << "the step that failed was the next";
}

TEST_F(NextStart, IsThatOfAWholeStep) {
    ClothStepperSettings in_parts = accurate(), in_small_steps = accurate();
    in_parts.substeps = 2;
    in_small_steps.step.small_step_rate = 120.0;
    for (const ClothStepperSettings& settings : {in_parts, in_small_steps}) {
        ClothStepper stepper(m_garment, settings);
        const auto take = [&] { return pull(stepper, 0.010, 1.0 / 30.0, 1.0); };
        const ClothState usual = take().state;
        stepper.start_next_at(usual.x);
        EXPECT_EQ(take().state.x, usual.x);
        EXPECT_EQ(take().state.x, usual.x);
    }
}

}  // namespace
}  // namespace cloth::next_start_test
