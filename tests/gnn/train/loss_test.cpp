#include "gnn/train/loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth::loss_test {
namespace {

/// A small pinned sheet that is thrown at a plane.
class Loss : public testing::Test {
 protected:
    Loss() {
        for (Eigen::Index i = 0; i < m_state.x.rows(); ++i)
            m_state.v.row(i) = Vec3(0.1, -0.4 + 0.5 * m_state.x(i, 0), 0.0).transpose();
        Obstacle floor;
        floor.shape = ObstacleShape::plane;
        floor.pose0.translation() = floor.pose1.translation() = Vec3(0, -0.012, 0);
        m_boundary.obstacles = {floor};
        m_boundary.pin_targets = m_state.x.row(0);
        Proximity().query(m_state.x, m_boundary, m_contacts);
        m_potential.begin_step(m_state, m_boundary, m_contacts, m_dt);
        starting_guess(m_garment, m_state, m_boundary, m_contacts, m_dt, 4e-3, m_base);
        m_target = m_base;
        QuasiNewton(m_garment).minimise(m_potential, m_target);
        m_x = m_base;
        for (Eigen::Index i = 1; i < m_x.rows(); ++i)  // some vertices come within contact distance
            m_x.row(i) +=
                2e-3 * Vec3(std::sin(3.0 * i), std::cos(5.0 * i), std::sin(7.0 * i)).transpose();
    }

    LossProblem problem() const {
        return {&m_potential, &m_laplacian, &m_boundary, &m_base, &m_target, 0.011, 0.0};
    }

    const double m_dt = 1.0 / 30.0;
    const Garment m_garment{"sheet", make_sheet(0.1, 0.1, 36), Fabric::soft_cotton(), {0}};
    ClothState m_state = ClothState::at_rest(m_garment);
    Boundary m_boundary;
    SurfaceContacts m_contacts;
    IncrementalPotential m_potential{m_garment};
    Eigen::SparseMatrix<double> m_laplacian = cotangent_laplacian(m_garment.rest());
    Points m_base, m_target, m_x;
};

class LossGradient : public Loss, public testing::WithParamInterface<LossKind> {};

TEST_P(LossGradient, EqualsFiniteDifferences) {
    LossValue loss, up, down;
    evaluate_loss(GetParam(), problem(), m_x, loss);
    const double h = 1e-7, scale = loss.gradient.cwiseAbs().maxCoeff();
    ASSERT_GT(scale, 0.0);
    for (Eigen::Index i = 1; i < m_x.rows(); ++i)
        for (int k = 0; k < 3; ++k) {
            Points x = m_x;
            x(i, k) += h;
            evaluate_loss(GetParam(), problem(), x, up);
            x(i, k) -= 2 * h;
            evaluate_loss(GetParam(), problem(), x, down);
            EXPECT_NEAR(loss.gradient(i, k), (up.value - down.value) / (2 * h), 1e-4 * scale);
        }
    EXPECT_EQ(loss.gradient.row(0).norm(), 0.0) << "pinned vertices are not the network's";
}

INSTANTIATE_TEST_SUITE_P(Kinds, LossGradient,
                         testing::Values(LossKind::energy, LossKind::log, LossKind::both));

TEST_P(LossGradient, EqualsFiniteDifferencesWithPositions) {
    LossProblem with_positions = problem(), without = problem();
    with_positions.position_weight = 2.0;
    LossValue loss, plain, up, down;
    evaluate_loss(GetParam(), with_positions, m_x, loss);
    evaluate_loss(GetParam(), without, m_x, plain);
    EXPECT_NEAR(loss.value - plain.value, 2.0 * std::log(loss.error + 0.1), 1e-12);
    const double h = 1e-7, scale = loss.gradient.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 1; i < m_x.rows(); i += 3)
        for (int k = 0; k < 3; ++k) {
            Points x = m_x;
            x(i, k) += h;
            evaluate_loss(GetParam(), with_positions, x, up);
            x(i, k) -= 2 * h;
            evaluate_loss(GetParam(), with_positions, x, down);
            EXPECT_NEAR(loss.gradient(i, k), (up.value - down.value) / (2 * h), 1e-4 * scale);
        }
    EXPECT_EQ(loss.gradient.row(0).norm(), 0.0) << "pinned vertices are not the network's";
}

TEST_F(Loss, PositionErrorIsOneAtTheGuessAndZeroAtTheTarget) {
    LossProblem with_positions = problem();
    with_positions.position_weight = 1.0;
    LossValue loss;
    evaluate_loss(LossKind::both, with_positions, m_base, loss);
    EXPECT_NEAR(loss.error, 1.0, 1e-12);
    evaluate_loss(LossKind::both, with_positions, m_target, loss);
    EXPECT_NEAR(loss.error, 0.0, 1e-5);
    EXPECT_TRUE(loss.gradient.allFinite());
}

TEST_F(Loss, FloorIsBelowTheMinimum) {
    const double floor = energy_floor(m_potential, m_boundary, m_base);
    EXPECT_LT(floor, m_potential.value(m_target));
    // Without obstacles and deformation the floor is met: free fall.
    m_boundary.obstacles.clear();
    const Garment free("sheet", m_garment.rest(), Fabric::soft_cotton());
    IncrementalPotential potential(free);
    ClothState rest = ClothState::at_rest(free);
    m_boundary.pin_targets.resize(0, 3);
    potential.begin_step(rest, m_boundary, {}, m_dt);
    Points fallen = rest.x;
    fallen.rowwise() += m_dt * m_dt * m_boundary.gravity.transpose();
    EXPECT_NEAR(energy_floor(potential, m_boundary, rest.x), potential.value(fallen), 1e-12);
}

TEST_F(Loss, GapIsOneAtTheGuessAndZeroAtTheTarget) {
    LossValue loss;
    evaluate_loss(LossKind::both, problem(), m_base, loss);
    EXPECT_NEAR(loss.gap, 1.0, 1e-12);
    evaluate_loss(LossKind::both, problem(), m_target, loss);
    EXPECT_NEAR(loss.gap, 0.0, 1e-12);
    EXPECT_TRUE(loss.gradient.allFinite());
}

TEST(LossNames, UnknownOnesAreRefused) {
    EXPECT_EQ(loss_named("log"), LossKind::log);
    EXPECT_THROW(loss_named("huber"), ArgumentError);
}

}  // namespace
}  // namespace cloth::loss_test
