#include "gnn/model/learned_stepper.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

/// A network that answers the same for every vertex.
class ConstantPredictor : public Predictor {
 public:
    explicit ConstantPredictor(const Vec3& answer) : m_answer(answer) {}
    const ModelConfig& config() const override { return m_config; }
    void predict(const ClothGraph& graph, const Features&, Points& out) override {
        out = m_answer.transpose().replicate(graph.vertex_count, 1);
    }

 private:
    ModelConfig m_config = ModelConfig::variant_named("fast");
    Vec3 m_answer;
};

class LearnedStep : public testing::Test {
 protected:
    LearnedStepper stepper(const Vec3& answer, Refinement refine) const {
        LearnedStepperSettings settings;
        settings.refine = refine;
        return LearnedStepper(m_garment, std::make_shared<ConstantPredictor>(answer), settings);
    }

    const TriMesh m_mesh = make_sheet(0.3, 0.3, 80);
    const Garment m_garment{"sheet", m_mesh, Fabric::soft_cotton(), {0, 3}};
    ClothState m_state = ClothState::at_rest(m_garment);
    Boundary m_boundary = [this] {
        Boundary boundary;
        boundary.pin_targets.resize(2, 3);
        boundary.pin_targets << m_mesh.vertices.row(0), m_mesh.vertices.row(3);
        return boundary;
    }();
    const double m_dt = 1.0 / 30.0;
};

TEST_F(LearnedStep, AddsScaledAccelerationsToTheGuess) {
    const Vec3 answer(0.5, -1.0, 0.25);
    LearnedStepper learned = stepper(answer, 0);
    const Points before = m_state.x;
    ASSERT_TRUE(learned.step(m_boundary, m_dt, m_state).finite);
    const Vec3 expected = before.row(1).transpose() + output_scale(m_dt) * answer;
    EXPECT_LT((m_state.x.row(1).transpose() - expected).norm(), 1e-15);
    EXPECT_LT((m_state.v.row(1).transpose() - (expected - before.row(1).transpose()) / m_dt).norm(),
              1e-12);
    EXPECT_EQ(m_state.x.row(0), m_boundary.pin_targets.row(0));
    EXPECT_DOUBLE_EQ(m_state.time, m_dt);
}

TEST_F(LearnedStep, AVelocityThatOverflowsFailsTheStep) {
    LearnedStepper learned = stepper(Vec3::Zero(), 0);
    m_boundary.pin_targets.array() += 1.0;
    const ClothState before = m_state;
    EXPECT_FALSE(learned.step(m_boundary, 1e-309, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.v, before.v);
}

TEST_F(LearnedStep, RefinesLikeTheSolverFromItsPrediction) {
    LearnedStepper learned = stepper(Vec3(0.0, -0.3, 0.0), 3);
    SurfaceContacts contacts;
    Proximity().query(m_state.x, m_boundary, contacts);
    IncrementalPotential potential(m_garment);
    potential.begin_step(m_state, m_boundary, contacts, m_dt);
    ASSERT_TRUE(learned.step(m_boundary, m_dt, m_state).finite);
    QuasiNewtonSettings settings;
    settings.iterations = 3;
    Points x = learned.prediction();
    QuasiNewton(m_garment, settings).minimise(potential, x);
    EXPECT_LT((m_state.x - x).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(potential.value(x), potential.value(learned.prediction()));
}

TEST_F(LearnedStep, FallsBackToTheGuessAndSaysSoIfTheNetworkFails) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    LearnedStepper failing = stepper(Vec3(nan, 0, 0), 2), silent = stepper(Vec3::Zero(), 2);
    ClothState other = m_state;
    EXPECT_TRUE(failing.step(m_boundary, m_dt, m_state).finite);
    EXPECT_TRUE(failing.last_step_fell_back());
    silent.step(m_boundary, m_dt, other);
    EXPECT_FALSE(silent.last_step_fell_back());
    EXPECT_EQ(m_state.x, other.x);
}

TEST_F(LearnedStep, ANetworkThatRaisesTheEnergyIsNotFollowed) {
    LearnedStepper absurd = stepper(Vec3(40.0, 300.0, 0), 2), silent = stepper(Vec3::Zero(), 2);
    ClothState other = m_state;
    EXPECT_TRUE(absurd.step(m_boundary, m_dt, m_state).finite);
    EXPECT_TRUE(absurd.last_step_fell_back());
    silent.step(m_boundary, m_dt, other);
    EXPECT_EQ(m_state.x, other.x);
}

TEST_F(LearnedStep, OffIsTheNetworksAnswerWhateverItsEnergy) {
    LearnedStepper absurd = stepper(Vec3(40.0, 300.0, 0), Refinement::off());
    const Points before = m_state.x;
    EXPECT_TRUE(absurd.step(m_boundary, m_dt, m_state).finite);
    EXPECT_FALSE(absurd.last_step_fell_back());
    EXPECT_GT((m_state.x - before).cwiseAbs().maxCoeff(), 1.0);
}

TEST_F(LearnedStep, RefinesUntilTheToleranceIsMetAndSaysSo) {
    LearnedStepper loose = stepper(Vec3(0, -0.3, 0), Refinement::until(0.5, 200));
    LearnedStepper tight = stepper(Vec3(0, -0.3, 0), Refinement::until(1e-3, 200));
    LearnedStepper hopeless = stepper(Vec3(0, -0.3, 0), Refinement::until(1e-9, 2));
    ClothState a = m_state, b = m_state, c = m_state;
    const StepReport first = loose.step(m_boundary, m_dt, a);
    const StepReport second = tight.step(m_boundary, m_dt, b);
    const StepReport third = hopeless.step(m_boundary, m_dt, c);
    EXPECT_TRUE(first.converged);
    EXPECT_LE(first.residual, 0.5);
    EXPECT_TRUE(second.converged);
    EXPECT_LE(second.residual, 1e-3);
    EXPECT_LT(first.iterations, second.iterations);
    EXPECT_FALSE(third.converged);
    EXPECT_EQ(third.iterations, 2);
}

TEST_F(LearnedStep, ByDefaultRefinesForAsLongAsThatGains) {
    Refinement patient;
    patient.least_gain = 1e-5;
    LearnedStepper loose = stepper(Vec3(0, -0.3, 0), Refinement());
    LearnedStepper tight = stepper(Vec3(0, -0.3, 0), patient);
    ClothState a = m_state, b = m_state;
    const StepReport first = loose.step(m_boundary, m_dt, a);
    const StepReport second = tight.step(m_boundary, m_dt, b);
    EXPECT_TRUE(first.converged);
    EXPECT_LT(first.gain, Refinement().least_gain);
    EXPECT_GE(first.iterations, Refinement().least);
    EXPECT_TRUE(second.converged);
    EXPECT_LT(second.gain, patient.least_gain);
    EXPECT_GT(second.iterations, first.iterations);
}

TEST_F(LearnedStep, LeavesTheStateUntouchedIfTheStepIsImpossible) {
    LearnedStepper learned = stepper(Vec3::Zero(), 2);
    const ClothState before = m_state;
    m_boundary.pin_targets.resize(1, 3);
    EXPECT_FALSE(learned.step(m_boundary, m_dt, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.time, before.time);
}

TEST_F(LearnedStep, PushesOutOfObstaclesWhatTheNetworkLeftInside) {
    Obstacle floor;
    floor.shape = ObstacleShape::plane;
    floor.pose0.translation() = floor.pose1.translation() = Vec3(0, -0.01, 0);
    m_boundary.obstacles = {floor};
    LearnedStepper learned = stepper(Vec3(0, -2.0, 0), 0);
    const StepReport report = learned.step(m_boundary, m_dt, m_state);
    EXPECT_LT(report.max_penetration, 1e-9);
    EXPECT_GT(m_state.x.col(1).minCoeff(), -0.01 - 1e-9);
}

TEST_F(LearnedStep, IsNamedAfterVariantAndIterations) {
    EXPECT_EQ(stepper(Vec3::Zero(), 2).name(), "fast+2");
    EXPECT_DOUBLE_EQ(stepper(Vec3::Zero(), 0).fixed_dt(), 1.0 / 30.0);
    EXPECT_EQ(stepper(Vec3::Zero(), Refinement::until(0.01, 30)).name(), "fast+1e-02");
    EXPECT_THROW(stepper(Vec3::Zero(), -1), ArgumentError);
    EXPECT_EQ(stepper(Vec3::Zero(), Refinement()).name(), "fast");
    EXPECT_THROW(stepper(Vec3::Zero(), Refinement::until(-1.0, 5)), ArgumentError);
    Refinement backwards;
    backwards.least_gain = -1e-3;
    EXPECT_THROW(stepper(Vec3::Zero(), backwards), ArgumentError);
}

}  // namespace
}  // namespace cloth
