#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::small_steps_test {
namespace {

constexpr double dt = 1.0 / 30.0;

ClothStepperSettings small(int count, int iterations) {
    ClothStepperSettings settings;
    settings.step = StepSettings::in_small_steps(count / dt, iterations);
    settings.guard = GuardSettings::off();
    return settings;
}

/// Parts that find contacts and project anew: slow and plain, the same physics.
ClothStepperSettings parts(int count, int iterations) {
    ClothStepperSettings settings =
        ClothStepperSettings::plain(IterationLimits::exactly(iterations));
    settings.substeps = count;
    return settings;
}

class SmallSteps : public ::testing::Test {
 protected:
    static Boundary boundary_of(const Garment& garment, const ClothState& state) {
        Boundary boundary;
        boundary.pin_targets.resize(static_cast<Eigen::Index>(garment.pins().size()), 3);
        for (size_t p = 0; p < garment.pins().size(); ++p)
            boundary.pin_targets.row(static_cast<Eigen::Index>(p)) = state.x.row(garment.pins()[p]);
        return boundary;
    }
    /// A sheet that two corners hold, level and on its way.
    const Garment m_hung{"sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton(), {0, 12}};
    const Garment m_free{"sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton(), {}};
    ClothState moving(const Garment& garment, const Vec3& v) const {
        ClothState state = ClothState::at_rest(garment);
        state.v.rowwise() = v.transpose();
        for (const int pin : garment.pins()) state.v.row(pin).setZero();
        return state;
    }
    /// How far the energy rises above what it was when the hanging sheet was let go, and what it is
    /// in the end: over its weight times its height.
    struct Rise {
        double most, end;
    };
    Rise rise_of(const Vec3& v, Integrator integrator) const {
        ClothState state = moving(m_hung, v);
        const Boundary boundary = boundary_of(m_hung, state);
        ClothStepperSettings settings = small(4, 3);
        settings.step.potential.integrator = integrator;
        ClothStepper stepper(m_hung, settings);
        const auto energy = [&] {
            double sum = *stepper.internal_energy(state.x);
            for (Eigen::Index i = 0; i < state.x.rows(); ++i)
                sum += m_hung.masses()[i] *
                       (0.5 * state.v.row(i).squaredNorm() + 9.81 * state.x(i, 1));
            return sum;
        };
        const double begun = energy(), scale = m_hung.masses().sum() * 9.81 * 0.4;
        double most = begun;
        for (int frame = 0; frame < 60; ++frame) {
            EXPECT_TRUE(stepper.step(boundary, dt, state).finite);
            most = std::max(most, energy());
        }
        return {(most - begun) / scale, (energy() - begun) / scale};
    }
    /// A few frames after it was let go.
    ClothState swung(ClothStepper& stepper) const {
        ClothState state = moving(m_hung, Vec3(0, -0.5, 0));
        const Boundary boundary = boundary_of(m_hung, state);
        for (int frame = 0; frame < 3; ++frame)
            EXPECT_TRUE(stepper.step(boundary, dt, state).finite);
        return state;
    }
};

TEST_F(SmallSteps, AreTheSameAsPartsWhereNothingIsTouched) {
    ClothStepper fast(m_hung, small(4, 300)), slow(m_hung, parts(4, 300));
    ClothState a = moving(m_hung, Vec3(0, -0.5, 0)), b = a;
    Boundary boundary = boundary_of(m_hung, a);
    for (int frame = 0; frame < 10; ++frame) {
        boundary.pin_targets.col(0).array() += 0.01;
        ASSERT_TRUE(fast.step(boundary, dt, a).finite);
        ASSERT_TRUE(slow.step(boundary, dt, b).finite);
        ASSERT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-5) << "frame " << frame;
        ASSERT_LT((a.v - b.v).cwiseAbs().maxCoeff(), 1e-3) << "frame " << frame;
    }
    EXPECT_NEAR(a.time, 10 * dt, 1e-12);
}

TEST_F(SmallSteps, FallNearerToTheParabola) {
    double error[2];
    for (const int count : {1, 8}) {
        ClothState state = moving(m_free, Vec3(0, -0.5, 0));
        ClothStepper stepper(m_free, small(count, 5));
        const Boundary boundary = boundary_of(m_free, state);
        for (int frame = 0; frame < 15; ++frame) stepper.step(boundary, dt, state);
        const double fallen = state.x(7, 1) - m_free.rest().vertices(7, 1);
        error[count == 8] = std::abs(fallen + 0.5 * 0.5 + 0.5 * 9.81 * 0.25);
    }
    EXPECT_NEAR(error[0], 0.5 * 9.81 * 0.5 * dt, 1e-6) << "too far by g t h / 2";
    EXPECT_NEAR(error[1], error[0] / 8, 1e-6);
}

TEST_F(SmallSteps, OnABallAreNearToParts) {
    ClothStepper fast(m_free, small(4, 20)), slow(m_free, parts(4, 20));
    ClothState a = moving(m_free, Vec3(0, -0.5, 0)), b = a;
    Boundary boundary = boundary_of(m_free, a);
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.radius = 0.1;
    ball.friction = 0.5;
    ball.pose0.translation() = Vec3(0.0, a.x.col(1).mean() - 0.13, 0.0);
    for (int frame = 0; frame < 15; ++frame) {
        ball.pose1 = ball.pose0;
        ball.pose1.translation().y() += 0.01;
        boundary.obstacles = {ball};
        const StepReport report = fast.step(boundary, dt, a);
        ASSERT_TRUE(report.finite);
        ASSERT_LT(report.max_penetration, 1e-3);
        ASSERT_TRUE(slow.step(boundary, dt, b).finite);
        ball.pose0 = ball.pose1;
    }
    const double off = std::sqrt((a.x - b.x).rowwise().squaredNorm().mean());
    EXPECT_LT(off, 5e-3) << "m, after half a second on a ball that rises";
}

/// A ball close above the sheet that flies away in every step.
Obstacle leaving(const ClothState& state) {
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.radius = 0.05;
    ball.pose0.translation() = Vec3(0.0, state.x.col(1).maxCoeff() + 0.08, 0.0);
    ball.pose1.translation() = ball.pose0.translation() + Vec3(0.0, 0.15, 0.0);
    return ball;
}

/// A cut finds contacts more often; what touches nothing moves as if there were none.
TEST_F(SmallSteps, AreKeptInStepsThatAreCutForTheirMotion) {
    const auto cut = [](int iterations) {
        ClothStepperSettings settings = small(4, iterations);
        settings.guard = GuardSettings();
        return settings;
    };
    ClothStepper whole(m_hung, small(4, 300)), guarded(m_hung, cut(300)), quick(m_hung, cut(3));
    ClothState a = moving(m_hung, Vec3(0, -0.5, 0)), b = a, c = a;
    Boundary boundary = boundary_of(m_hung, a);
    int steps_cut = 0;
    for (int frame = 0; frame < 10; ++frame) {
        boundary.obstacles = {leaving(a)};
        EXPECT_EQ(whole.step(boundary, dt, a).substeps, 1);
        steps_cut += guarded.step(boundary, dt, b).substeps > 1;
        ASSERT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-5) << "frame " << frame;
        ASSERT_LT((a.v - b.v).cwiseAbs().maxCoeff(), 1e-3) << "frame " << frame;
        boundary.obstacles = {leaving(c)};
        EXPECT_EQ(quick.step(boundary, dt, c).iterations, 4 * 3) << "frame " << frame;
    }
    EXPECT_GE(steps_cut, 6);
}

TEST_F(SmallSteps, ClothAtRestTakesOneStepOfAsManyIterationsAsGain) {
    ClothState a = ClothState::at_rest(m_hung), b = a;
    const Boundary boundary = boundary_of(m_hung, a);
    ClothStepperSettings one = ClothStepperSettings::plain();
    one.step.quasi_newton = IterationLimits::controlled(12);
    one.step.quasi_newton.contact_cg_iterations = 5;
    const StepReport report = ClothStepper(m_hung, small(4, 3)).step(boundary, dt, a);
    EXPECT_GE(report.iterations, 12);
    ClothStepper(m_hung, one).step(boundary, dt, b);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.v, b.v);
}

TEST_F(SmallSteps, AStepMayBeTakenAgainFromWhereItBegan) {
    ClothStepper stepper(m_hung, small(4, 3));
    const ClothState state = swung(stepper);
    const Boundary boundary = boundary_of(m_hung, state);
    ClothState first = state, again = state, third = state;
    stepper.step(boundary, dt, first);
    stepper.step(boundary, dt, again);
    stepper.step(boundary, dt, third);
    EXPECT_EQ(first.x, again.x) << "with the velocity at the end of the step before, too";
    EXPECT_EQ(first.v, again.v);
    EXPECT_EQ(first.x, third.x);
}

TEST_F(SmallSteps, GoOnWhereTheStateWasMovedAsARigidBody) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3::UnitY()).toRotationMatrix();
    const Eigen::RowVector3d way(0.3, 0.0, -0.2);
    ClothStepper here(m_free, small(4, 3)), there(m_free, small(4, 3));
    ClothState a = moving(m_free, Vec3(0.2, -0.5, 0.1)), b = a;
    const Boundary boundary = boundary_of(m_free, a);
    for (ClothStepper* stepper : {&here, &there})
        stepper->step(boundary, dt, stepper == &here ? a : b);
    const Points before = b.x;
    b.x = (b.x * turn.transpose()).rowwise() + way;
    b.v *= turn.transpose();
    there.moved(before, b.x, turn);
    here.step(boundary, dt, a);
    there.step(boundary, dt, b);
    EXPECT_LT((((a.x * turn.transpose()).rowwise() + way) - b.x).cwiseAbs().maxCoeff(), 1e-6);
    const Points fallen = a.x - m_free.rest().vertices;
    EXPECT_NEAR(fallen(7, 1), -0.5 * 2 * dt - 9.81 * dt * dt / 16 * 8 * 9 / 2, 1e-5);
}

TEST_F(SmallSteps, InternalForcesAreTheMeanOverThem) {
    ClothStepper stepper(m_free, small(4, 60));
    ClothState state = moving(m_free, Vec3(0, -0.5, 0));
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) state.x(i, 0) *= 1.05;  // stretched
    const Boundary boundary = boundary_of(m_free, state);
    ASSERT_TRUE(stepper.step(boundary, dt, state).finite);  // from rest to the mean velocity
    Points v = state.v, forces;
    ASSERT_TRUE(stepper.step(boundary, dt, state).finite);
    ASSERT_TRUE(stepper.internal_forces(state.x, forces));
    EXPECT_LT(forces.colwise().sum().norm(), 1e-9);
    Points at_end;
    Points elsewhere = state.x;
    elsewhere(0, 0) += 1e-12;
    ASSERT_TRUE(stepper.internal_forces(elsewhere, at_end));
    EXPECT_GT((forces - at_end).norm(), 0.1 * at_end.norm()) << "it swings back within the step";
}

TEST_F(SmallSteps, AStepThatFailsLeavesTheState) {
    ClothStepper stepper(m_hung, small(4, 3));
    ClothState state = swung(stepper);
    const Boundary boundary = boundary_of(m_hung, state);
    const ClothState before = state;
    EXPECT_FALSE(stepper.step(boundary, std::numeric_limits<double>::min(), state).finite);
    EXPECT_EQ(state.x, before.x);
    EXPECT_EQ(state.v, before.v);
    EXPECT_EQ(state.time, before.time);
    EXPECT_TRUE(stepper.step(boundary, dt, state).finite);
}

/// In an order of its own: compilers differ in which argument they evaluate first.
Vec3 random_velocity(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> speed(-1.0, 1.0);
    const double z = speed(random), y = speed(random), x = speed(random);
    return {x, y, z};
}

TEST_F(SmallSteps, EnergyNeverRises) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const auto integrator = seed % 2 == 0 ? Integrator::bdf2 : Integrator::backward_euler;
        const Rise rise = rise_of(random_velocity(seed), integrator);
        EXPECT_LT(rise.most, 0.02) << "seed " << seed;
        EXPECT_LT(rise.end, -0.1) << "seed " << seed << ": it hangs";
    }
    for (unsigned seed = 9; seed <= 24; ++seed)
        EXPECT_LT(rise_of(random_velocity(seed), Integrator::backward_euler).most, 0.02)
            << "seed " << seed;
}

/// In worlds of any velocity BDF2 overshoots by more than in those above: of two moments it keeps
/// another energy from rising.
TEST_F(SmallSteps, EnergyOfBdf2RisesLittleAfterTheStart) {
    for (unsigned seed = 9; seed <= 24; ++seed) {
        const Rise rise = rise_of(random_velocity(seed), Integrator::bdf2);
        EXPECT_LT(rise.most, 0.05) << "seed " << seed;
        EXPECT_LT(rise.end, -0.1) << "seed " << seed << ": it hangs";
    }
}

/// How much energy a stiff sheet gains that lands flat on a table narrower than itself, in units of
/// what it falls for. Of half the table's length (m): where its corners bear the sheet, contact
/// projection holds faces out of them, and stretches them for a while.
double gained_on_a_table(const ClothStepperSettings& settings, double half_length) {
    const Garment sheet("sheet", make_sheet(0.8, 0.8, 400), Fabric::real_cotton(), {});
    ClothState state = ClothState::at_rest(sheet);
    Obstacle table;
    table.shape = ObstacleShape::box;
    table.half_extents = Vec3(0.25, 0.2, half_length);
    table.friction = 1.0;
    table.pose0.translation() = Vec3(0.0, state.x.col(1).mean() - 0.35, 0.0);
    table.pose1 = table.pose0;
    Boundary boundary;
    boundary.obstacles = {table};
    ClothStepper stepper(sheet, settings);
    const VectorX& mass = sheet.masses();
    const auto energy = [&] {
        return 0.5 * mass.dot(state.v.rowwise().squaredNorm()) + 9.81 * mass.dot(state.x.col(1)) +
               *stepper.internal_energy(state.x);
    };
    double least = energy(), gained = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
        EXPECT_TRUE(stepper.step(boundary, 1.0 / 60.0, state).finite);
        least = std::min(least, energy());
        gained = std::max(gained, energy() - least);
    }
    return gained / (9.81 * mass.sum() * 0.15);
}

TEST_F(SmallSteps, OfFewIterationsMakeNoEnergyWhereStiffClothLandsFlat) {
    ClothStepperSettings settings = small(4, 3);
    EXPECT_LT(gained_on_a_table(settings, 0.25), 0.03);
    EXPECT_LT(gained_on_a_table(settings, 1.0), 0.01);
    settings.step = StepSettings::newton_in_small_steps();
    EXPECT_LT(gained_on_a_table(settings, 1.0), 0.01);
}

TEST_F(SmallSteps, OfStiffClothAreNewtonStepsUnlessTheyAreAskedFor) {
    Fabric between = Fabric::soft_cotton();
    between.mu *= 4.0;
    between.lambda *= 4.0;
    const auto name_with = [](const Fabric& fabric, const ClothStepperSettings& settings) {
        const Garment sheet("sheet", make_sheet(0.3, 0.3, 50), fabric, {});
        return ClothStepper(sheet, settings).name();
    };
    EXPECT_EQ(name_with(Fabric::real_cotton(), {}), "quasi-newton-1s120-cg10");
    EXPECT_EQ(name_with(between, {}), "quasi-newton-3s120");
    EXPECT_EQ(name_with(Fabric::real_cotton(), small(4, 3)), "quasi-newton-3s120");
    ClothStepperSettings settings;
    settings.step = StepSettings::whole();
    EXPECT_EQ(name_with(Fabric::real_cotton(), settings), "quasi-newton");
    settings = {};
    settings.step.stiff_cg_iterations = 20;
    EXPECT_EQ(name_with(Fabric::real_cotton(), settings), "quasi-newton-1s120-cg20");
    settings.step.stiff_cg_iterations = 201;
    EXPECT_THROW(name_with(Fabric::real_cotton(), settings), ArgumentError);
}

/// At 30 Hz a hanging sheet of real cotton, which small steps of the history let sink as if in
/// honey, falls by its own weight.
TEST_F(SmallSteps, OfStiffClothFallFreely) {
    const Garment sheet("sheet", make_sheet(1.0, 1.0, 400), Fabric::real_cotton(), {0, 19});
    const auto fallen = [&](const ClothStepperSettings& settings) {
        ClothState state = ClothState::at_rest(sheet);
        const double begun = state.x.col(1).mean();
        const Boundary boundary = boundary_of(sheet, state);
        ClothStepper stepper(sheet, settings);
        for (int frame = 0; frame < 10; ++frame)
            EXPECT_TRUE(stepper.step(boundary, dt, state).finite);
        return begun - state.x.col(1).mean();
    };
    const double right = fallen(ClothStepperSettings::reference());
    EXPECT_GT(fallen({}), 0.9 * right);
    EXPECT_LT(fallen(small(4, 3)), 0.9 * right);
}

/// By Newton's method a step of cloth that hardly moves goes on for as long as that gains anything.
TEST_F(SmallSteps, OfStiffClothAtRestAreOneIteration) {
    const Garment sheet("sheet", make_sheet(1.0, 1.0, 400), Fabric::real_cotton(), {0, 19});
    ClothState state = ClothState::at_rest(sheet);
    Boundary boundary = boundary_of(sheet, state);
    ClothStepper stepper(sheet);
    for (int frame = 0; frame < 200; ++frame) {
        stepper.step(boundary, dt, state);
        state.v *= 0.8;  // or it would swing for long
    }
    ASSERT_LT(state.v.rowwise().norm().maxCoeff(), 0.01) << "it has not come to rest";
    const StepReport rests = stepper.step(boundary, dt, state);
    EXPECT_EQ(rests.iterations, 1);
    EXPECT_TRUE(rests.converged);
    EXPECT_LT(rests.gain.value(), 1e-4);
    boundary.gravity *= 3.0;
    const StepReport pulled = stepper.step(boundary, dt, state);
    EXPECT_GT(pulled.iterations, 1) << "what has to move is not left behind";
    EXPECT_LE(pulled.iterations, 4);
}

TEST_F(SmallSteps, WithoutTimeAreOneStepOfOneIteration) {
    ClothStepper stepper(m_hung, small(4, 3));
    ASSERT_TRUE(stepper.set_max_ms(1e-6));
    ClothState state = moving(m_hung, Vec3(0, -0.5, 0));
    const Boundary boundary = boundary_of(m_hung, state);
    const StepReport report = stepper.step(boundary, dt, state);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.out_of_time);
    EXPECT_EQ(report.iterations, 1);
    EXPECT_EQ(report.substeps, 1);
}

TEST_F(SmallSteps, ShareTheIterationsThatAStepMayTake) {
    ClothStepper stepper(m_hung, small(4, 3));
    ASSERT_TRUE(stepper.set_max_iterations(8));
    ClothState state = moving(m_hung, Vec3(0, -0.5, 0));
    const Boundary boundary = boundary_of(m_hung, state);
    EXPECT_EQ(stepper.step(boundary, dt, state).iterations, 8);
    EXPECT_EQ(stepper.solver().small_steps(dt), 4);
    stepper.set_max_iterations(5);
    EXPECT_EQ(stepper.solver().small_steps(dt), 2) << "of two iterations or more each";
    EXPECT_EQ(stepper.step(boundary, dt, state).iterations, 4);
    stepper.set_max_iterations(1);
    EXPECT_EQ(stepper.step(boundary, dt, state).iterations, 1) << "in a whole step";
}

/// Predicts the same acceleration (m/s^2) for all vertices.
class Uniform : public StepStart {
 public:
    /// @param length  of the steps that it is for (s)
    explicit Uniform(const Vec3& acceleration, double length = dt)
        : m_acceleration(acceleration), m_length(length) {}
    std::string name() const override { return "uniform"; }
    double fixed_dt() const override { return m_length; }
    bool predict(const ClothState&, const Boundary&, const IncrementalPotential&,
                 const Points& guess, PotentialValue&, Points& prediction, StageTimes&) override {
        ++asked;
        prediction = guess.rowwise() + m_length * m_length * m_acceleration.transpose();
        return false;
    }
    int asked = 0;

 private:
    Vec3 m_acceleration;
    double m_length;
};

TEST_F(SmallSteps, SettingsThatDoNotGoTogetherAreRefused) {
    for (const double bad : {-1.0, 1.1e4, std::numeric_limits<double>::quiet_NaN()}) {
        ClothStepperSettings settings;
        settings.step.small_step_rate = bad;
        EXPECT_THROW(ClothStepper(m_hung, settings), ArgumentError);
    }
}

TEST_F(SmallSteps, StandInTheName) {
    EXPECT_EQ(ClothStepper(m_hung).name(), "quasi-newton-3s120");
    ClothStepperSettings settings = small(2, 5);
    settings.step.potential.integrator = Integrator::bdf2;
    EXPECT_EQ(ClothStepper(m_hung, settings).name(), "quasi-newton-5s60-bdf2");
    settings.step = StepSettings::whole();
    EXPECT_EQ(ClothStepper(m_hung, settings).name(), "quasi-newton");
    settings.step = StepSettings::newton_in_small_steps(240.0, 20);
    EXPECT_EQ(ClothStepper(m_hung, settings).name(), "quasi-newton-1s240-cg20");
    const auto start = std::make_shared<Uniform>(Vec3::Zero());
    EXPECT_EQ(ClothStepper(m_hung, {}, start).name(), "uniform+3s120");
    EXPECT_EQ(ClothStepper(m_hung, small(2, 3), start).name(), "uniform+3s60");
}

TEST_F(SmallSteps, AreAsManyAsMakeTheRate) {
    const StepSolver solver(m_hung, StepSettings::in_small_steps(120.0));
    EXPECT_EQ(solver.small_steps(1.0 / 240.0), 1);
    EXPECT_EQ(solver.small_steps(static_cast<double>(1.0f / 120.0f)), 1);
    EXPECT_EQ(solver.small_steps(static_cast<double>(1.0f / 60.0f)), 2);
    EXPECT_EQ(solver.small_steps(0.02), 3);
    EXPECT_EQ(solver.small_steps(1.0 / 30.0), 4);
    EXPECT_EQ(solver.small_steps(2.0), 64) << "at most";
    EXPECT_EQ(StepSolver(m_hung, StepSettings::whole()).small_steps(2.0), 1);
}

TEST_F(SmallSteps, ShareOutWhatAStartPredicts) {
    // a fall that the start knows of needs no iteration, and one that is wrong is not taken
    for (const double known : {-9.81, 300.0}) {
        const auto start = std::make_shared<Uniform>(Vec3(0, known, 0));
        ClothStepper told(m_free, small(4, 1), start), untold(m_free, small(4, 1));
        ClothState a = moving(m_free, Vec3(0, -0.5, 0)), b = a;
        const Boundary boundary = boundary_of(m_free, a);
        const StepReport report = told.step(boundary, dt, a);
        ASSERT_TRUE(report.finite);
        untold.step(boundary, dt, b);
        EXPECT_EQ(report.prediction_rejected, known > 0.0);
        EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-9);
        EXPECT_EQ(start->asked, 1) << "once a step";
        const double fallen = a.x(7, 1) - m_free.rest().vertices(7, 1);
        EXPECT_NEAR(fallen, -0.5 * dt - 9.81 * dt * dt * 10 / 16, 1e-9) << "1 + 2 + 3 + 4 of 16";
    }
}

TEST_F(SmallSteps, OfAStartThatFailsGoOnWithoutIt) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ClothStepper told(m_hung, small(4, 3), std::make_shared<Uniform>(Vec3(nan, nan, nan)));
    ClothStepper untold(m_hung, small(4, 3));
    ClothState a = moving(m_hung, Vec3(0, -0.5, 0)), b = a;
    const Boundary boundary = boundary_of(m_hung, a);
    const StepReport report = told.step(boundary, dt, a);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.prediction_rejected);
    untold.step(boundary, dt, b);
    EXPECT_EQ(a.x, b.x);
}

TEST_F(SmallSteps, OfAnotherLengthAreMadeWithoutTheStart) {
    const auto start = std::make_shared<Uniform>(Vec3(0, -9.81, 0));
    ClothStepper told(m_hung, small(4, 3), start), untold(m_hung, small(4, 3));
    ClothState a = moving(m_hung, Vec3(0, -0.5, 0)), b = a;
    const Boundary boundary = boundary_of(m_hung, a);
    EXPECT_TRUE(told.step(boundary, 0.02, a).finite);
    untold.step(boundary, 0.02, b);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(start->asked, 0);
}

TEST_F(SmallSteps, AskAStartOfTheirLengthInEach) {
    for (const int iterations : {0, 60}) {
        const auto start = std::make_shared<Uniform>(Vec3(0, -7.0, 0), dt / 4);
        ClothStepper stepper(m_hung, small(4, iterations), start);
        ClothStepperSettings one = small(1, iterations);
        one.step.small_step_rate = 0.0;
        ClothStepper by_hand(m_hung, one, std::make_shared<Uniform>(Vec3(0, -7.0, 0), dt / 4));
        EXPECT_EQ(stepper.fixed_dt(), 0.0) << "any step will do";
        EXPECT_EQ(by_hand.fixed_dt(), dt / 4);
        ClothState a = moving(m_hung, Vec3(0.3, -0.5, 0)), b = a;
        const Boundary boundary = boundary_of(m_hung, a);
        const StepReport report = stepper.step(boundary, dt, a);
        ASSERT_TRUE(report.finite);
        EXPECT_EQ(report.iterations, 4 * iterations);
        EXPECT_EQ(start->asked, 4);
        bool rejected = false;
        for (int k = 0; k < 4; ++k)
            rejected = by_hand.step(boundary, dt / 4, b).prediction_rejected || rejected;
        EXPECT_EQ(report.prediction_rejected, rejected);
        // Iterations of a small step know those of the one before; many end at the minimum.
        EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), iterations == 0 ? 1e-12 : 1e-5);
        stepper.step(boundary, dt / 4, a);
        EXPECT_EQ(start->asked, 5) << "a whole step of that length is one";
        stepper.step(boundary, 0.02, a);
        EXPECT_EQ(start->asked, 5);
    }
}

TEST_F(SmallSteps, OfWhichAStartSpoilsOneSayIt) {
    /// Not finite when it is asked for the second time.
    class Once : public Uniform {
     public:
        Once() : Uniform(Vec3::Zero(), dt / 4) {}
        bool predict(const ClothState& state, const Boundary& boundary,
                     const IncrementalPotential& potential, const Points& guess,
                     PotentialValue& at_guess, Points& prediction, StageTimes& times) override {
            Uniform::predict(state, boundary, potential, guess, at_guess, prediction, times);
            if (asked == 2) prediction(3, 1) = std::numeric_limits<double>::infinity();
            return false;
        }
    };
    ClothStepper stepper(m_hung, small(4, 0), std::make_shared<Once>());
    ClothState state = moving(m_hung, Vec3(0, -0.5, 0));
    const StepReport report = stepper.step(boundary_of(m_hung, state), dt, state);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.prediction_rejected);
    EXPECT_TRUE(state.x.allFinite());
}

}  // namespace
}  // namespace cloth::small_steps_test
