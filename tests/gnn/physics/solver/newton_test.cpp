#include "gnn/physics/solver/newton.h"

#include <limits>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::newton_test {

using namespace cloth::test;

namespace {

/// A moving sheet that hangs by two corners, at the start of a step.
class NewtonTest : public ::testing::TestWithParam<Fabric> {
 protected:
    Garment garment{"sheet", sheet(9, 0.4), GetParam(), {0, 8}};
    IncrementalPotential potential{garment};
    Boundary boundary;
    Points start;

    NewtonTest() {
        ClothState state = ClothState::at_rest(garment);
        state.v.col(2) = state.x.col(2);
        boundary.pin_targets = state.x.row(0).replicate(2, 1);
        boundary.pin_targets.row(1) = state.x.row(8);
        potential.begin_step(state, boundary, {}, 1.0 / 30.0);
        starting_guess(garment, state, boundary, {}, 1.0 / 30.0, 4e-3, start);
    }
};

}  // namespace

TEST_P(NewtonTest, ReportsTheMinimumItLeavesInX) {
    Newton newton(garment);
    Points x = start, gradient;
    const MinimiseReport report = newton.minimise(potential, x);
    EXPECT_TRUE(report.converged);
    EXPECT_LT(report.iterations, 20);
    EXPECT_DOUBLE_EQ(report.energy, potential.value_gradient(x, gradient));
    EXPECT_DOUBLE_EQ(report.residual, gradient.norm() / potential.force_scale());
    EXPECT_LE(report.residual, 1e-4);
    EXPECT_EQ(x.row(0), start.row(0));
    EXPECT_EQ(x.row(8), start.row(8));
}

TEST_P(NewtonTest, NoNearbyPointHasLessEnergy) {
    NewtonSettings settings;
    settings.tolerance = 1e-8;
    Newton newton(garment, settings);
    Points x = start;
    const MinimiseReport report = newton.minimise(potential, x);
    ASSERT_TRUE(report.converged);
    for (unsigned seed = 0; seed < 50; ++seed) {
        Points direction = noise(x.rows(), 1e-5, seed);
        for (int pin : garment.pins()) direction.row(pin).setZero();
        EXPECT_GT(potential.value(x + direction), report.energy);
    }
}

TEST_P(NewtonTest, EnergyNeverRisesFromOneIterationToTheNext) {
    NewtonSettings settings;
    settings.max_iterations = 1;
    Newton newton(garment, settings);
    Points x = start + noise(start.rows(), 0.01, 3);
    double before = potential.value(x);
    for (int k = 0; k < 30; ++k) {
        const MinimiseReport report = newton.minimise(potential, x);
        EXPECT_LE(report.energy, before + 1e-12 * std::fabs(before));
        before = report.energy;
    }
}

TEST_P(NewtonTest, ProjectedHessiansAloneReachTheSameMinimum) {
    NewtonSettings projected;
    projected.exact_below = 0.0;
    projected.max_iterations = 200;
    Points x = start, y = start;
    ASSERT_TRUE(Newton(garment).minimise(potential, x).converged);
    ASSERT_TRUE(Newton(garment, projected).minimise(potential, y).converged);
    EXPECT_LT((x - y).rowwise().norm().maxCoeff(), 1e-3);
}

TEST_P(NewtonTest, AVeryBadStartStillConverges) {
    NewtonSettings patient;
    patient.max_iterations = 500;
    Points x = start + noise(start.rows(), 0.05, 1);  // triangles are turned over
    for (size_t k = 0; k < garment.pins().size(); ++k)
        x.row(garment.pins()[k]) = start.row(garment.pins()[k]);
    const MinimiseReport report = Newton(garment, patient).minimise(potential, x);
    EXPECT_TRUE(report.converged) << "residual " << report.residual;
}

TEST_P(NewtonTest, WhatIsNotFiniteIsLeftAsItIs) {
    Newton newton(garment);
    Points x = start;
    x(3, 1) = std::numeric_limits<double>::quiet_NaN();
    Points before = x;
    EXPECT_FALSE(newton.minimise(potential, x).finite);
    before(3, 1) = x(3, 1) = 0.0;
    EXPECT_EQ(x, before);
    Points short_x = start.topRows(5);
    EXPECT_FALSE(newton.minimise(potential, short_x).finite);
}

TEST_P(NewtonTest, SettingsOutOfRangeAreRefused) {
    NewtonSettings settings;
    settings.tolerance = -1.0;
    EXPECT_THROW(Newton(garment, settings), ArgumentError);
    settings = {};
    settings.max_iterations = -1;
    EXPECT_THROW(Newton(garment, settings), ArgumentError);
}

INSTANTIATE_TEST_SUITE_P(Fabrics, NewtonTest,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace cloth::newton_test
