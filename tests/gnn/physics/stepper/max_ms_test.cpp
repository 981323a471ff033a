#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::max_ms_test {
namespace {

constexpr double frame_time = 1.0 / 30.0;
constexpr double no_time = 1e-6;  // ms
constexpr double kHour = 3.6e6;   // ms

/// A level sheet above a ball.
class MaxMs : public ::testing::Test {
 protected:
    const Garment m_garment{"sheet", make_sheet(0.8, 0.8, 600), Fabric::soft_cotton(), {}};
    ClothState m_state = ClothState::at_rest(m_garment);

    Boundary ball(double from, double to) const {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        Obstacle sphere;
        sphere.shape = ObstacleShape::sphere;
        sphere.radius = 0.1;
        const double y = m_state.x.col(1).mean();
        sphere.pose0.translation() = Vec3(0, y + from, 0);
        sphere.pose1.translation() = Vec3(0, y + to, 0);
        boundary.obstacles = {sphere};
        return boundary;
    }
};

TEST_F(MaxMs, WithTimeToSpareNothingChanges) {
    const Boundary boundary = ball(-0.6, 0.6);
    ClothState free = m_state;
    ClothStepper unlimited(m_garment), limited(m_garment);
    EXPECT_TRUE(limited.set_max_ms(1e7));
    for (int frame = 0; frame < 5; ++frame) {
        unlimited.step(boundary, frame_time, free);
        EXPECT_FALSE(limited.step(boundary, frame_time, m_state).out_of_time);
    }
    EXPECT_EQ(m_state.x, free.x);
    EXPECT_EQ(m_state.v, free.v);
}

TEST_F(MaxMs, WithoutTimeAStepIsOneIterationAndNothingEndsInside) {
    const Boundary boundary = ball(-0.11, -0.11);
    ClothStepper stepper(m_garment);
    stepper.set_max_ms(no_time);
    double slack = 0.0;
    for (int frame = 0; frame < 30; ++frame) {
        const StepReport report = stepper.step(boundary, frame_time, m_state);
        ASSERT_TRUE(report.finite);
        EXPECT_TRUE(report.out_of_time);
        EXPECT_EQ(report.substeps, 1);
        EXPECT_EQ(report.iterations, 1);
        EXPECT_LE(report.max_penetration, 1e-4);
        ASSERT_TRUE(report.residual);
        slack = std::max(slack, *report.residual);
    }
    EXPECT_GT(slack, 1e-3) << "what is left of the forces tells how far the iterations got";
    stepper.set_max_ms(std::numeric_limits<double>::infinity());
    const StepReport report = stepper.step(boundary, frame_time, m_state);
    EXPECT_FALSE(report.out_of_time);
    EXPECT_GT(report.iterations, 1);
}

TEST_F(MaxMs, WithoutTimeFastStepsAreCutIntoFewerParts) {
    ClothStepper unlimited(m_garment), limited(m_garment);
    ClothState free = m_state;
    EXPECT_EQ(unlimited.step(ball(-0.9, 0.6), frame_time, free).substeps, 16);
    limited.set_max_ms(no_time);
    limited.step(ball(-0.9, -0.9), frame_time, m_state);  // shows what a part costs
    const StepReport report = limited.step(ball(-0.9, 0.6), frame_time, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.out_of_time);
    EXPECT_EQ(report.substeps, 1);
    EXPECT_LE(report.max_penetration, 1e-4);
}

/// Its whole steps say that they took an hour for so many iterations, and ask for parts: hours, so
/// that how fast the machine is does not count.
class SlowWhole : public StepSolver {
 public:
    SlowWhole(const Garment& garment, int iterations)
        : StepSolver(garment, StepSettings::whole()), m_iterations(iterations) {}
    StepReport whole(const Boundary& boundary, double dt, ClothState& state) override {
        StepReport report = StepSolver::whole(boundary, dt, state);
        report.times = {};
        report.times.solve = kHour;
        report.iterations = m_iterations;
        report.max_entry = 1.0;
        return report;
    }
    StepReport correct(const Boundary&, double, const TunnellingDetector*, const IterationLimits&,
                       ClothState&) override {
        return StepReport::failed();
    }

 private:
    int m_iterations;
};

TEST_F(MaxMs, PartsThatCouldNotHaveFiveIterationsAreNotTaken) {
    ClothStepper dear(m_garment, std::make_unique<SlowWhole>(m_garment, 1));  // 5 hours a part
    dear.set_max_ms(7.5 * kHour);
    EXPECT_EQ(dear.step(ball(-0.15, -0.09), frame_time, m_state).substeps, 1);
    ClothStepper cheap(m_garment, std::make_unique<SlowWhole>(m_garment, 100));  // 3 minutes
    cheap.set_max_ms(7.5 * kHour);
    m_state = ClothState::at_rest(m_garment);
    EXPECT_GT(cheap.step(ball(-0.15, -0.09), frame_time, m_state).substeps, 1);
}

TEST_F(MaxMs, StepsThatAreAlwaysCutStayCut) {
    ClothStepperSettings settings;
    settings.substeps = 4;
    settings.max_ms = 0.1;
    ClothStepper stepper(m_garment, settings);
    for (int frame = 0; frame < 3; ++frame) {
        const StepReport report = stepper.step(ball(-0.9, 0.6), frame_time, m_state);
        EXPECT_TRUE(report.finite);
        EXPECT_GE(report.substeps, 4);
    }
}

/// Its whole steps fail.
class FailingWhole : public StepSolver {
 public:
    explicit FailingWhole(const Garment& garment) : StepSolver(garment, StepSettings::whole()) {}
    StepReport whole(const Boundary&, double, ClothState&) override { return StepReport::failed(); }
};

TEST_F(MaxMs, AStepThatFailsIsTakenAgainWhateverTheTime) {
    ClothStepper stepper(m_garment, std::make_unique<FailingWhole>(m_garment));
    stepper.set_max_ms(no_time);
    for (int frame = 0; frame < 3; ++frame) {
        const StepReport report = stepper.step(ball(-0.11, -0.11), frame_time, m_state);
        EXPECT_TRUE(report.finite);
        EXPECT_EQ(report.substeps, 2);
    }
}

TEST_F(MaxMs, NewtonsMethodKnowsNoLimit) {
    ClothStepper stepper(m_garment, ClothStepperSettings::reference());
    EXPECT_FALSE(stepper.set_max_ms(5.0));
}

TEST_F(MaxMs, LimitsOutOfRangeAreRefused) {
    ClothStepperSettings settings;
    for (const double bad : {0.05, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        settings.max_ms = bad;
        EXPECT_THROW(ClothStepper(m_garment, settings), ArgumentError);
    }
    for (const double good : {0.1, 1e9, std::numeric_limits<double>::infinity()}) {
        settings.max_ms = good;
        EXPECT_NO_THROW(ClothStepper(m_garment, settings));
    }
}

}  // namespace
}  // namespace cloth::max_ms_test
