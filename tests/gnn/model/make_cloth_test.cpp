#include "gnn/model/make_cloth.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::make_cloth_test {
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

ModelConfig small_config() {
    ModelConfig config = ModelConfig::variant_named("fast");
    config.width = 16;
    config.steps = 2;
    return config;
}

class NetworkStep : public testing::Test {
 protected:
    std::unique_ptr<ClothStepper> made(const Vec3& answer, const IterationLimits& limits) const {
        return make_cloth(m_garment, std::make_shared<ConstantPredictor>(answer),
                          ClothStepperSettings::plain(limits));
    }
    std::unique_ptr<ClothStepper> made(const Vec3& answer, int iterations) const {
        return made(answer, IterationLimits::exactly(iterations));
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

TEST_F(NetworkStep, AddsScaledAccelerationsToTheGuess) {
    const Vec3 answer(0.5, -1.0, 0.25);
    const auto learned = made(answer, 0);
    const Points before = m_state.x;
    ASSERT_TRUE(learned->step(m_boundary, m_dt, m_state).finite);
    const Vec3 expected = before.row(1).transpose() + output_scale(m_dt) * answer;
    EXPECT_LT((m_state.x.row(1).transpose() - expected).norm(), 1e-15);
    EXPECT_LT((m_state.v.row(1).transpose() - (expected - before.row(1).transpose()) / m_dt).norm(),
              1e-12);
    EXPECT_EQ(m_state.x.row(0), m_boundary.pin_targets.row(0));
    EXPECT_DOUBLE_EQ(m_state.time, m_dt);
}

TEST_F(NetworkStep, AVelocityThatOverflowsFailsTheStep) {
    const auto learned = made(Vec3::Zero(), 0);
    m_boundary.pin_targets.array() += 1.0;
    const ClothState before = m_state;
    EXPECT_FALSE(learned->step(m_boundary, 1e-309, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.v, before.v);
}

TEST_F(NetworkStep, RefinesLikeTheSolverFromItsPrediction) {
    const auto learned = made(Vec3(0.0, -0.3, 0.0), 3);
    SurfaceContacts contacts;
    Proximity().query(m_state.x, m_boundary, contacts);
    IncrementalPotential potential(m_garment);
    potential.begin_step(m_state, m_boundary, contacts, m_dt);
    ASSERT_TRUE(learned->step(m_boundary, m_dt, m_state).finite);
    Points x = learned->solver().start();
    QuasiNewton(m_garment, IterationLimits::exactly(3)).minimise(potential, x);
    EXPECT_LT((m_state.x - x).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT(potential.value(x), potential.value(learned->solver().start()));
}

TEST_F(NetworkStep, FallsBackToTheGuessAndSaysSoIfTheNetworkFails) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto failing = made(Vec3(nan, 0, 0), 2), silent = made(Vec3::Zero(), 2);
    ClothState other = m_state;
    const StepReport report = failing->step(m_boundary, m_dt, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.prediction_rejected);
    EXPECT_FALSE(silent->step(m_boundary, m_dt, other).prediction_rejected);
    EXPECT_EQ(m_state.x, other.x);
}

TEST_F(NetworkStep, ANetworkThatRaisesTheEnergyIsNotFollowed) {
    const auto absurd = made(Vec3(40.0, 300.0, 0), 2), silent = made(Vec3::Zero(), 2);
    ClothState other = m_state;
    const StepReport report = absurd->step(m_boundary, m_dt, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_TRUE(report.prediction_rejected);
    silent->step(m_boundary, m_dt, other);
    EXPECT_EQ(m_state.x, other.x);
}

TEST_F(NetworkStep, OffIsTheNetworksAnswerWhateverItsEnergy) {
    const auto absurd = made(Vec3(40.0, 300.0, 0), IterationLimits::none());
    const Points before = m_state.x;
    const StepReport report = absurd->step(m_boundary, m_dt, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_FALSE(report.prediction_rejected);
    EXPECT_FALSE(report.residual);
    EXPECT_GT((m_state.x - before).cwiseAbs().maxCoeff(), 1.0);
}

TEST_F(NetworkStep, RefinesUntilTheToleranceIsMetAndSaysSo) {
    const auto loose = made(Vec3(0, -0.3, 0), IterationLimits::until(0.5, 200));
    const auto tight = made(Vec3(0, -0.3, 0), IterationLimits::until(1e-3, 200));
    const auto hopeless = made(Vec3(0, -0.3, 0), IterationLimits::until(1e-9, 2));
    ClothState a = m_state, b = m_state, c = m_state;
    const StepReport first = loose->step(m_boundary, m_dt, a);
    const StepReport second = tight->step(m_boundary, m_dt, b);
    const StepReport third = hopeless->step(m_boundary, m_dt, c);
    EXPECT_TRUE(first.converged);
    EXPECT_LE(first.residual.value(), 0.5);
    EXPECT_TRUE(second.converged);
    EXPECT_LE(second.residual.value(), 1e-3);
    EXPECT_LT(first.iterations, second.iterations);
    EXPECT_FALSE(third.converged);
    EXPECT_EQ(third.iterations, 2);
}

TEST_F(NetworkStep, ByDefaultRefinesForAsLongAsThatGains) {
    IterationLimits patient = IterationLimits::controlled();
    patient.least_gain = 1e-5;
    const auto loose = made(Vec3(0, -0.3, 0), IterationLimits::controlled());
    const auto tight = made(Vec3(0, -0.3, 0), patient);
    ClothState a = m_state, b = m_state;
    const StepReport first = loose->step(m_boundary, m_dt, a);
    const StepReport second = tight->step(m_boundary, m_dt, b);
    EXPECT_TRUE(first.converged);
    EXPECT_LT(first.gain.value(), IterationLimits::controlled().least_gain);
    EXPECT_GE(first.iterations, IterationLimits::controlled().least_iterations);
    EXPECT_TRUE(second.converged);
    EXPECT_LT(second.gain.value(), patient.least_gain);
    EXPECT_GT(second.iterations, first.iterations);
}

TEST_F(NetworkStep, LeavesTheStateUntouchedIfTheStepIsImpossible) {
    const auto learned = made(Vec3::Zero(), 2);
    const ClothState before = m_state;
    m_boundary.pin_targets.resize(1, 3);
    EXPECT_FALSE(learned->step(m_boundary, m_dt, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.time, before.time);
}

TEST_F(NetworkStep, PushesOutOfObstaclesWhatTheNetworkLeftInside) {
    Obstacle floor;
    floor.shape = ObstacleShape::plane;
    floor.pose0.translation() = floor.pose1.translation() = Vec3(0, -0.01, 0);
    m_boundary.obstacles = {floor};
    const auto learned = made(Vec3(0, -2.0, 0), 0);
    const StepReport report = learned->step(m_boundary, m_dt, m_state);
    EXPECT_LT(report.max_penetration, 1e-9);
    EXPECT_GT(m_state.x.col(1).minCoeff(), -0.01 + StepSettings().safety_distance - 1e-9);
}

TEST_F(NetworkStep, IsNamedAfterVariantAndIterations) {
    EXPECT_EQ(made(Vec3::Zero(), 2)->name(), "fast+2");
    EXPECT_DOUBLE_EQ(made(Vec3::Zero(), 0)->fixed_dt(), 1.0 / 30.0);
    EXPECT_EQ(made(Vec3::Zero(), IterationLimits::until(0.01, 30))->name(), "fast+1e-02");
    EXPECT_THROW(made(Vec3::Zero(), -1), ArgumentError);
    EXPECT_EQ(made(Vec3::Zero(), IterationLimits::controlled())->name(), "fast");
    EXPECT_THROW(made(Vec3::Zero(), IterationLimits::until(-1.0, 5)), ArgumentError);
    IterationLimits backwards = IterationLimits::controlled();
    backwards.least_gain = -1e-3;
    EXPECT_THROW(made(Vec3::Zero(), backwards), ArgumentError);
}

TEST_F(NetworkStep, IsNamedAfterItsWeightsWhereTheyHaveAName) {
    ClothSettings settings;
    settings.step = StepSettings::whole(IterationLimits::exactly(2));
    Weights weights = test::random_weights(small_config());
    const auto name = [&] {
        settings.weights = std::make_shared<const EngineWeights>(weights);
        return make_cloth(m_garment, settings)->name();
    };
    EXPECT_EQ(name(), "fast+2");
    weights.called = "small";
    EXPECT_EQ(name(), "small+2");
    settings.step = StepSettings();
    EXPECT_EQ(name(), "small") << "whole steps";
    settings.small_steps_from_network = true;
    EXPECT_EQ(name(), "small+3s120");
}

TEST_F(NetworkStep, IsIndependentUnlessThePredictorIsShared) {
    const ClothStepperSettings settings;
    EXPECT_TRUE(make_cloth(m_garment)->is_independent());
    ClothSettings learned;
    learned.weights = std::make_shared<const EngineWeights>(test::random_weights(small_config()));
    EXPECT_TRUE(make_cloth(m_garment, learned)->is_independent());
    auto engine = std::make_shared<Engine>(learned.weights);
    const auto one = make_cloth(m_garment, engine, settings);
    EXPECT_FALSE(one->is_independent());
    engine.reset();
    EXPECT_TRUE(one->is_independent());
    EXPECT_FALSE(made(Vec3::Zero(), 1)->is_independent()) << "the predictor does not say so";
}

TEST_F(NetworkStep, EnergiesOfGuessAndPredictionComeFromTheFeatures) {
    // A network without force features computes none: the step does, to the same bits.
    class Plain : public ConstantPredictor {
     public:
        explicit Plain(const Vec3& answer) : ConstantPredictor(answer) {
            m_plain = ModelConfig::variant_named("fast");
            m_plain.features.force_features = false;
        }
        const ModelConfig& config() const override { return m_plain; }

     private:
        ModelConfig m_plain;
    };
    const Vec3 answer(0.0, -0.3, 0.0);
    const auto settings = ClothStepperSettings::plain(IterationLimits::exactly(3));
    ClothState other = m_state;
    const StepReport with =
        make_cloth(m_garment, std::make_shared<ConstantPredictor>(answer), settings)
            ->step(m_boundary, m_dt, m_state);
    const StepReport without = make_cloth(m_garment, std::make_shared<Plain>(answer), settings)
                                   ->step(m_boundary, m_dt, other);
    EXPECT_EQ(with.prediction_rejected, without.prediction_rejected);
    EXPECT_EQ(m_state.x, other.x);
}

TEST_F(NetworkStep, StepsOfAnotherLengthAreMadeWithoutTheNetwork) {
    const auto learned = made(Vec3(0, -2.0, 0), 0);
    EXPECT_TRUE(learned->accepts_any_dt());
    ClothState other = m_state, unguarded = m_state;
    ASSERT_TRUE(learned->step(m_boundary, 0.5 * m_dt, other).finite);
    EXPECT_EQ(learned->solver().start().rows(), 0);
    ClothStepperSettings settings;
    settings.step = StepSettings::whole(GuardSettings().iterations);
    settings.guard = GuardSettings::off();
    ClothStepper(m_garment, settings).step(m_boundary, 0.5 * m_dt, unguarded);
    EXPECT_EQ(other.x, unguarded.x);
    ASSERT_TRUE(learned->step(m_boundary, m_dt * (1.0 + 1e-6), m_state).finite);
    EXPECT_EQ(learned->solver().start().rows(), m_state.x.rows()) << "rounding of a float";
}

TEST_F(NetworkStep, WithoutANetworkClothIsPhysicsAlone) {
    const auto cloth = make_cloth(m_garment);
    EXPECT_EQ(cloth->name(), "quasi-newton-3s120");
    EXPECT_EQ(cloth->fixed_dt(), 0.0);
    ClothState other = m_state;
    ASSERT_TRUE(cloth->step(m_boundary, m_dt, m_state).finite);
    ClothStepper(m_garment).step(m_boundary, m_dt, other);
    EXPECT_EQ(m_state.x, other.x);
}

}  // namespace
}  // namespace cloth::make_cloth_test
