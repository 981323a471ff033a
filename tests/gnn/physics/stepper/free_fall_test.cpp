#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "data/authoring/sheet.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::free_fall_test {
namespace {

/// Cloth that nothing holds.
class FreeFall : public ::testing::Test {
 protected:
    static constexpr double gravity = 9.81;  // m/s^2
    void wrinkle() {
        for (Eigen::Index i = 0; i < m_state.x.rows(); ++i) {
            const double x = m_state.x(i, 0), z = m_state.x(i, 2);
            m_state.x(i, 1) += 0.02 * std::sin(40.0 * x) * std::cos(30.0 * z);
            m_state.x.row(i) *= 0.97;
            m_state.v.row(i) << 0.5 * std::sin(20.0 * z), std::cos(15.0 * x), 3.0 * x;
        }
    }
    double height() const { return mean(m_state.x); }
    double fallingSpeed() const { return -mean(m_state.v); }
    double mean(const Points& rows) const {
        return m_garment.masses().dot(rows.col(1)) / m_garment.masses().sum();
    }
    const Garment m_garment{"sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton()};
    ClothState m_state = ClothState::at_rest(m_garment);
};

TEST_F(FreeFall, IsThatOfAStoneForStepsOfAnyLengths) {
    const std::vector<std::vector<double>> lengths = {{1.0 / 60},
                                                      {1.0 / 30, 1.0 / 60},
                                                      {0.0082, 0.0085},
                                                      {1.0 / 60, 1.0 / 144},
                                                      {1.0 / 30, 1.0 / 144},
                                                      {1.0 / 60, 1.0 / 60, 1.0 / 60, 0.1}};
    for (const std::vector<double>& dt : lengths) {
        ClothStepper stepper(m_garment);
        m_state = ClothState::at_rest(m_garment);
        for (size_t k = 0; m_state.time < 1.0; ++k)
            EXPECT_TRUE(stepper.step({}, dt[k % dt.size()], m_state).finite);
        const double t = m_state.time, longest = *std::max_element(dt.begin(), dt.end());
        EXPECT_NEAR(fallingSpeed(), gravity * t, gravity * 0.75 * longest) << dt[0];
        EXPECT_NEAR(height(), -0.5 * gravity * t * t, 0.5 * gravity * t * longest) << dt[0];
    }
}

TEST_F(FreeFall, OfWrinkledClothGainsNoMomentum) {
    Boundary far;
    Obstacle floor;
    floor.shape = ObstacleShape::plane;
    floor.pose0.translation().y() = floor.pose1.translation().y() = -20.0;
    far.obstacles = {floor};
    for (const Boundary& boundary : {Boundary(), far})
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
            ClothStepper stepper(m_garment);
            m_state = ClothState::at_rest(m_garment);
            wrinkle();
            stepper.step(boundary, dt, m_state);
            for (int k = 0; k < 30; ++k) {
                const double before = fallingSpeed();
                stepper.step(boundary, dt, m_state);
                EXPECT_NEAR((fallingSpeed() - before) / dt, gravity, 1e-6) << dt << ", step " << k;
            }
        }
}

TEST(RestingCloth, TakesManyIterationsWhereAStepIsASmallOne) {
    const Garment garment("sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton(), {0, 1});
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    boundary.pin_targets = state.x.topRows(2);
    ClothStepper stepper(garment);
    EXPECT_GE(stepper.step(boundary, 1.0 / 240, state).iterations, 10);
    state.v.col(1).setConstant(1.0);
    EXPECT_LE(stepper.step(boundary, 1.0 / 240, state).iterations, 3);
}

}  // namespace
}  // namespace cloth::free_fall_test
