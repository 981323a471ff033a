#include "gnn/physics/stepper/substepped_stepper.h"

#include <gtest/gtest.h>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/quasi_newton_stepper.h"

namespace cloth {
namespace {

constexpr double dt = 1.0 / 30.0;

std::unique_ptr<Stepper> quasi_newton(const Garment& garment, int iterations = 20) {
    QuasiNewtonSettings settings;
    settings.iterations = iterations;
    return std::make_unique<QuasiNewtonStepper>(garment, settings);
}

/// Keeps what it is given and moves nothing.
class Recorder : public Stepper {
 public:
    explicit Recorder(std::vector<Boundary>& seen, int fails_at = -1)
        : m_seen(seen), m_fails_at(fails_at) {}
    std::string name() const override { return "recorder"; }
    StepReport step(const Boundary& boundary, double h, ClothState& state) override {
        StepReport report;
        report.finite = static_cast<int>(m_seen.size()) != m_fails_at;
        m_seen.push_back(boundary);
        report.iterations = 2;
        report.times.solve = 1.0;
        state.x.array() += report.finite ? h : 0.0;
        return report;
    }

 private:
    std::vector<Boundary>& m_seen;
    int m_fails_at;
};

class Substeps : public ::testing::Test {
 protected:
    const Garment m_garment{"sheet", make_sheet(0.3, 0.3, 80), Fabric::soft_cotton(), {0, 3}};
    ClothState m_state = ClothState::at_rest(m_garment);
    Boundary m_boundary = [this] {
        Boundary boundary;
        boundary.pin_targets.resize(2, 3);
        boundary.pin_targets.row(0) = m_state.x.row(0) + Vec3(0.03, 0, 0).transpose();
        boundary.pin_targets.row(1) = m_state.x.row(3) + Vec3(0, 0.06, 0).transpose();
        return boundary;
    }();
};

TEST_F(Substeps, PartsOfAMotionJoinAndEndWhereItEnds) {
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.pose0.translation() = Vec3(1, 0, 0);
    ball.pose1.translation() = Vec3(2, 0.3, 0);
    ball.pose1.linear() = Eigen::AngleAxisd(1.0, Vec3::UnitY()).toRotationMatrix();
    Obstacle mesh;
    mesh.faces = std::make_shared<const Faces>(m_garment.rest().faces);
    mesh.x0 = m_garment.rest().vertices;
    mesh.x1 = mesh.x0.array() + 0.7;
    m_boundary.obstacles = {ball, mesh};
    std::vector<Boundary> parts;
    SubsteppedStepper stepper(m_garment, std::make_unique<Recorder>(parts), 3);
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    ASSERT_EQ(parts.size(), 3u);
    EXPECT_EQ(report.iterations, 6);
    EXPECT_DOUBLE_EQ(report.times.solve, 3.0);
    EXPECT_EQ(parts[0].obstacles[1].x0, mesh.x0);
    EXPECT_EQ(parts[2].obstacles[1].x1, mesh.x1);
    EXPECT_EQ(parts[2].pin_targets, m_boundary.pin_targets);
    EXPECT_TRUE(parts[0].obstacles[0].pose0.matrix() == ball.pose0.matrix());
    EXPECT_TRUE(parts[2].obstacles[0].pose1.matrix() == ball.pose1.matrix());
    for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(parts[k].obstacles[1].x1, parts[k + 1].obstacles[1].x0);
        EXPECT_TRUE(parts[k].obstacles[0].pose1.matrix() ==
                    parts[k + 1].obstacles[0].pose0.matrix());
    }
    const double angle =
        Eigen::AngleAxisd(Eigen::Matrix3d(parts[0].obstacles[0].pose1.linear())).angle();
    EXPECT_NEAR(angle, 1.0 / 3.0, 1e-12);
    EXPECT_NEAR(parts[0].obstacles[0].pose1.translation().x(), 4.0 / 3.0, 1e-12);
    EXPECT_NEAR(parts[0].pin_targets(1, 1), m_garment.rest().vertices(3, 1) + 0.02, 1e-12);
}

TEST_F(Substeps, EqualSmallStepsByHand) {
    SubsteppedStepper stepper(m_garment, quasi_newton(m_garment), 4);
    ClothState by_hand = m_state;
    const auto inner = quasi_newton(m_garment);
    const Points from = m_state.x;
    ASSERT_TRUE(stepper.step(m_boundary, dt, m_state).finite);
    for (int k = 1; k <= 4; ++k) {
        Boundary part = m_boundary;
        if (k < 4)
            for (int p = 0; p < 2; ++p)
                part.pin_targets.row(p) = (1 - k / 4.0) * from.row(m_garment.pins()[p]) +
                                          k / 4.0 * m_boundary.pin_targets.row(p);
        ASSERT_TRUE(inner->step(part, dt / 4, by_hand).finite);
    }
    EXPECT_EQ(m_state.x, by_hand.x);
    EXPECT_LT((m_state.v - (m_state.x - from) / dt).cwiseAbs().maxCoeff(), 1e-12);
    // and goes on from the last sub-step's velocity
    ASSERT_TRUE(stepper.step(m_boundary, dt, m_state).finite);
    for (int k = 1; k <= 4; ++k) ASSERT_TRUE(inner->step(m_boundary, dt / 4, by_hand).finite);
    EXPECT_LT((m_state.x - by_hand.x).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_DOUBLE_EQ(m_state.time, 2 * dt);
    EXPECT_EQ(m_state.x.row(3), m_boundary.pin_targets.row(1));
}

TEST_F(Substeps, FallNearerToTheParabola) {
    const Garment free("sheet", m_garment.rest(), Fabric::soft_cotton());
    m_boundary.pin_targets.resize(0, 3);
    double error[2];
    for (const int substeps : {1, 8}) {
        ClothState state = ClothState::at_rest(free);
        SubsteppedStepper stepper(free, quasi_newton(free), substeps);
        for (int frame = 0; frame < 15; ++frame) stepper.step(m_boundary, dt, state);
        const double fallen = state.x(7, 1) - free.rest().vertices(7, 1);
        error[substeps == 8] = std::abs(fallen + 0.5 * 9.81 * 0.25);
    }
    // Backward Euler falls too far by g t h / 2.
    EXPECT_NEAR(error[0], 0.5 * 9.81 * 0.5 * dt, 1e-6);
    EXPECT_NEAR(error[1], error[0] / 8, 1e-6);
}

TEST_F(Substeps, AFailureInTheMiddleLeavesTheStateAsItWas) {
    std::vector<Boundary> parts;
    SubsteppedStepper stepper(m_garment, std::make_unique<Recorder>(parts, 1), 3);
    const ClothState before = m_state;
    EXPECT_FALSE(stepper.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(parts.size(), 2u);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.time, before.time);
}

TEST_F(Substeps, RefusesWhatCannotBeCut) {
    EXPECT_THROW(SubsteppedStepper(m_garment, nullptr, 2), ArgumentError);
    EXPECT_THROW(SubsteppedStepper(m_garment, quasi_newton(m_garment), 0), ArgumentError);
    EXPECT_THROW(SubsteppedStepper(m_garment, quasi_newton(m_garment), 65), ArgumentError);
    EXPECT_EQ(SubsteppedStepper(m_garment, quasi_newton(m_garment, 3), 4).name(),
              "quasi-newton-3x4");
}

}  // namespace
}  // namespace cloth
