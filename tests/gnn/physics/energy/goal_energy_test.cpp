#include "gnn/physics/energy/goal_energy.h"

#include <Eigen/Eigenvalues>

#include "data/core/errors.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/goal_hessian.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::goal_energy_test {

using namespace cloth::test;

namespace {

constexpr double dt = 1.0 / 30.0;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A deformed sheet around goals that move: every kind of limit is crossed somewhere.
class GoalEnergyTest : public ::testing::Test {
 protected:
    Garment garment = Garment("sheet", sheet(6, 0.3), Fabric::soft_cotton(), {0, 5});
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    Points x;

    GoalEnergyTest() {
        const Eigen::Index count = garment.vertex_count();
        GoalLimits limits;
        limits.max_distance.setConstant(count, infinity);
        limits.backstop.setConstant(count, infinity);
        limits.drive_stiffness.setZero(count);
        limits.drive_damping.setZero(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            if (i % 2 == 0) limits.max_distance[i] = i % 4 == 0 ? 0.0 : 0.01;
            if (i % 3 == 0) limits.backstop[i] = 0.002;
            if (i % 5 < 2) limits.drive_stiffness[i] = 100.0;
            if (i % 7 < 3) limits.drive_damping[i] = 20.0;
        }
        garment = garment.with_goals(limits);
        boundary.goals = {state.x + noise(count, 0.02, 1), state.x + noise(count, 0.02, 2),
                          noise(count, 1.0, 3), noise(count, 1.0, 4)};
        x = state.x + noise(count, 0.02, 5);
    }
};

}  // namespace

TEST_F(GoalEnergyTest, IsATermOfThePotential) {
    IncrementalPotential potential(garment);
    potential.begin_step(state, boundary, {}, dt);
    Points with, without;
    const double energy = potential.value_gradient(x, with);
    const EnergyTerms terms = potential.terms(x);
    EXPECT_GT(terms.goals, 0.0);
    EXPECT_DOUBLE_EQ(energy, terms.total());
    Boundary plain = boundary;
    const Garment free = garment.with_goals({});
    IncrementalPotential other(free);
    other.begin_step(state, plain, {}, dt);
    EXPECT_NEAR(energy - other.value_gradient(x, without), terms.goals, 1e-9 * terms.goals);
    EXPECT_GT((with - without).norm(), 0.0);
    EXPECT_EQ(with.row(0).norm(), 0.0) << "of a pin";
}

TEST_F(GoalEnergyTest, GradientEqualsFiniteDifferences) {
    GoalEnergy energy(garment);
    energy.begin_step(state, boundary.goals, dt, 10.0);
    expect_gradient([&](const Points& y) { return energy.value(y); },
                    [&](const Points& y, Points& gradient) {
                        gradient.setZero(y.rows(), 3);
                        energy.add_gradient(y, gradient);
                    },
                    x, 1e-6, 1e-6);
    Points gradient = Points::Zero(x.rows(), 3);
    EXPECT_DOUBLE_EQ(energy.add_gradient(x, gradient), energy.value(x));
}

TEST_F(GoalEnergyTest, HessianEqualsFiniteDifferencesAndTheQuasiNewtonBlocks) {
    IncrementalPotential potential(garment);
    potential.begin_step(state, boundary, {}, dt);
    const GoalEnergy& energy = potential.goals();
    Points direction = noise(x.rows(), 1.0, 7);
    for (const int pin : garment.pins()) direction.row(pin).setZero();
    const Points numeric = numeric_hessian_product(
        [&](const Points& y, Points& gradient) {
            gradient.setZero(y.rows(), 3);
            energy.add_gradient(y, gradient);
        },
        x, direction, 1e-7);
    const BlockPattern pattern(garment);
    Eigen::SparseMatrix<double> hessian;
    pattern.reset(hessian);
    energy.add_hessian(x, pattern, hessian.valuePtr());
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    expect_close(product, numeric, 1e-5);

    std::vector<int> row_of;
    for (int i = 0; i < garment.vertex_count(); ++i) row_of.push_back(i);
    GoalHessian blocks;
    blocks.begin_step(energy, row_of);
    blocks.linearise(x);
    Points by_blocks = Points::Zero(x.rows(), 3);
    for (const GoalHessian::Block& block : blocks.blocks()) {
        by_blocks.row(block.row) += direction.row(block.row) * block.stiffness;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> values(block.stiffness);
        EXPECT_GE(values.eigenvalues().minCoeff(), -1e-12 * block.stiffness.norm());
    }
    expect_close(by_blocks, numeric, 1e-5);
}

TEST_F(GoalEnergyTest, IsZeroWithinTheLimitsForWhatIsNotDriven) {
    GoalLimits limits = garment.goal_limits();
    limits.drive_stiffness.setZero();
    limits.drive_damping.setZero();
    const Garment undriven = garment.with_goals(limits);
    GoalEnergy energy(undriven);
    energy.begin_step(state, boundary.goals, dt, 10.0);
    Points y = x;
    for (const VertexGoal& goal : energy.limits())
        y.row(goal.vertex) = goal.within(x.row(goal.vertex)).transpose();
    EXPECT_GT(energy.value(x), 0.0);
    EXPECT_LT(energy.value(y), 1e-20);
}

TEST_F(GoalEnergyTest, ATrialNeverGoesMuchFartherBeyondALimit) {
    GoalEnergy energy(garment);
    energy.begin_step(state, boundary.goals, dt, 10.0);
    Points trial = x + noise(x.rows(), 0.05, 11);
    for (const VertexGoal& goal : energy.limits()) {
        const double allowed = allowed_excess(goal, x.row(goal.vertex));
        limit_excess(goal, allowed, trial);
        EXPECT_LE(goal.excess(trial.row(goal.vertex)), allowed + 1e-12);
    }
}

TEST_F(GoalEnergyTest, AGarmentWithLimitsAsksForItsGoals) {
    IncrementalPotential potential(garment);
    boundary.goals = {};
    EXPECT_THROW(potential.begin_step(state, boundary, {}, dt), ArgumentError);
}

}  // namespace cloth::goal_energy_test
