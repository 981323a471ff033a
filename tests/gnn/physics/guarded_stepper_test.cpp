#include "gnn/physics/guarded_stepper.h"

#include <gtest/gtest.h>

#include "data/errors.h"
#include "data/sheet.h"
#include "gnn/physics/quasi_newton_stepper.h"

namespace cloth {
namespace {

constexpr double dt = 1.0 / 30.0;

class Failing : public Stepper {
 public:
    std::string name() const override { return "failing"; }
    StepReport step(const Boundary&, double, ClothState&) override {
        StepReport report;
        report.finite = false;
        return report;
    }
};

std::unique_ptr<Stepper> quasi_newton(const Garment& garment) {
    return std::make_unique<QuasiNewtonStepper>(garment, QuasiNewtonSettings{});
}

/// A ball that starts 0.6 m beside the sheet's middle and moves along x.
Obstacle ball(double from, double to) {
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    sphere.radius = 0.1;
    sphere.pose0.translation() = Vec3(from, 0, 0);
    sphere.pose1.translation() = Vec3(to, 0, 0);
    return sphere;
}

class Guard : public ::testing::Test {
 protected:
    /// A sheet in the plane x = 0.
    static TriMesh upright() {
        TriMesh mesh = make_sheet(0.8, 0.8, 600);
        for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
            const Vec3 x = mesh.vertices.row(i);
            mesh.vertices.row(i) = Vec3(0, x.z(), x.x()).transpose();
        }
        return mesh;
    }
    const Garment m_garment{"sheet", upright(), Fabric::soft_cotton(), {}};
    ClothState m_state = ClothState::at_rest(m_garment);
    Boundary m_boundary = [] {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        boundary.gravity.setZero();
        return boundary;
    }();
};

TEST_F(Guard, AStepThatNeedsNoneIsTheInnerOne) {
    m_boundary.obstacles = {ball(-0.15, -0.12)};
    ClothState alone = m_state;
    const auto inner = quasi_newton(m_garment);
    GuardedStepper guarded(m_garment, quasi_newton(m_garment));
    for (int k = 0; k < 3; ++k) {
        inner->step(m_boundary, dt, alone);
        guarded.step(m_boundary, dt, m_state);
        EXPECT_EQ(guarded.last_substeps(), 1);
        m_boundary.obstacles = {ball(-0.12 + 0.03 * k, -0.09 + 0.03 * k)};
    }
    EXPECT_EQ(m_state.x, alone.x);
    EXPECT_EQ(m_state.v, alone.v);
    EXPECT_EQ(guarded.guarded_steps(), 0);
}

TEST_F(Guard, AFastBallCarriesTheSheetInsteadOfPassingThrough) {
    // 12 m/s: 40 cm in a frame
    m_boundary.obstacles = {ball(-0.3, 0.1)};
    ClothState alone = m_state;
    quasi_newton(m_garment)->step(m_boundary, dt, alone);
    GuardedStepper guarded(m_garment, quasi_newton(m_garment));
    ASSERT_TRUE(guarded.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(guarded.last_substeps(), 4);
    int behind = 0, behind_alone = 0;
    for (Eigen::Index i = 0; i < m_state.x.rows(); ++i) {
        const Vec3 rest = m_garment.rest().vertices.row(i);
        if (rest.norm() > 0.07) continue;  // was in the ball's way
        behind += m_state.x(i, 0) < 0.1;
        behind_alone += alone.x(i, 0) < 0.1;
    }
    EXPECT_EQ(behind, 0);
    EXPECT_GT(behind_alone, 0) << "the scene is no test: one step holds it as well";
}

TEST_F(Guard, CoMovingObstaclesAreNotFast) {
    m_state.v.rowwise() = Eigen::RowVector3d(12, 0, 0);
    m_boundary.obstacles = {ball(-0.15, 0.25)};
    EXPECT_NEAR(relative_motion(m_garment, m_boundary, dt, m_state), 0.0, 1e-12);
    m_boundary.obstacles = {ball(5.0, 9.0)};  // fast, but far away
    EXPECT_EQ(relative_motion(m_garment, m_boundary, dt, m_state), 0.0);
}

TEST_F(Guard, PinsThatJumpAreCutToo) {
    const Garment pinned("sheet", m_garment.rest(), Fabric::soft_cotton(), {0, 3});
    m_boundary.pin_targets.resize(2, 3);
    for (int p = 0; p < 2; ++p)
        m_boundary.pin_targets.row(p) =
            m_state.x.row(pinned.pins()[p]) + Vec3(0.35, 0, 0).transpose();
    GuardedStepper guarded(pinned, quasi_newton(pinned));
    ASSERT_TRUE(guarded.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(guarded.last_substeps(), 4);
    EXPECT_EQ(m_state.x.row(0), m_boundary.pin_targets.row(0));
}

TEST_F(Guard, AFailedStepIsMadeByTheSolver) {
    GuardedStepper guarded(m_garment, std::make_unique<Failing>());
    m_boundary.gravity = Vec3(0, -9.81, 0);
    ASSERT_TRUE(guarded.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(guarded.guarded_steps(), 1);
    EXPECT_LT(m_state.x.col(1).mean(), m_garment.rest().vertices.col(1).mean());
    EXPECT_DOUBLE_EQ(m_state.time, dt);
}

TEST_F(Guard, AnImpossibleStepStillFailsAndChangesNothing) {
    GuardedStepper guarded(m_garment, quasi_newton(m_garment));
    const ClothState before = m_state;
    m_boundary.gravity.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(guarded.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
}

TEST_F(Guard, SubstepsObeyThePhysicsOfTheStep) {
    m_boundary.obstacles = {ball(-0.15, 0.25)};
    const auto after = [&](double contact_distance) {
        QuasiNewtonSettings settings = QuasiNewtonSettings::controlled();
        settings.potential.contact_distance = contact_distance;
        ClothState state = m_state;
        EXPECT_TRUE(make_physics_cloth(m_garment, settings)->step(m_boundary, dt, state).finite);
        return state.x;
    };
    GuardSettings by_hand;
    by_hand.solver.potential.contact_distance = 8e-3;
    ClothState state = m_state;
    GuardedStepper guard(m_garment, quasi_newton(m_garment), by_hand);
    guard.step(m_boundary, dt, state);
    ASSERT_GT(guard.last_substeps(), 1);
    EXPECT_TRUE(same_points(after(8e-3), state.x));
    EXPECT_FALSE(same_points(after(4e-3), state.x));
}

TEST_F(Guard, RefusesSettingsOutOfRange) {
    GuardSettings settings;
    settings.max_motion = 0.0;
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
    settings = {};
    settings.max_substeps = 0;
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
    EXPECT_THROW(GuardedStepper(m_garment, nullptr), ArgumentError);
    settings = {};
    settings.solver.iterations = -1;
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
}

}  // namespace
}  // namespace cloth
