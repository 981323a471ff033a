#include "gnn/physics/stepper/embedded_stepper.h"

#include <string>
#include <utility>

#include "data/authoring/make_proxy.h"
#include "data/authoring/sheet.h"
#include "data/core/carry_over.h"
#include "data/core/errors.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/gnn/stepper_contract.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

using Proxy = std::shared_ptr<const Garment>;

EmbeddedStepperSettings with_detail(int iterations) {
    EmbeddedStepperSettings settings;
    settings.detail_iterations = iterations;
    return settings;
}

std::unique_ptr<Stepper> five_iterations(const Garment& garment) {
    return std::make_unique<ClothStepper>(garment,
                                          ClothStepperSettings::plain(IterationLimits::exactly(5)));
}

std::unique_ptr<Stepper> xpbd_of(const Garment& garment) {
    return std::make_unique<XpbdStepper>(garment);
}

/// The contract's sheets, of 8 x 8 vertices and more, follow one of 5 x 5.
StepperCase embedded(const std::string& name,
                     std::unique_ptr<Stepper> (*make_stepper)(const Garment&),
                     int detail_iterations = 0) {
    const auto make = [=](const Garment& garment) -> std::unique_ptr<Stepper> {
        const Proxy proxy =
            std::make_shared<const Garment>(carry_over(garment, sheet(5, 0.5), "proxy"));
        return std::make_unique<EmbeddedStepper>(garment, proxy, make_stepper(*proxy),
                                                 with_detail(detail_iterations));
    };
    return {name, make, 1e-6, {}};
}

StepperCase embedded_xpbd() {
    StepperCase result = embedded("Xpbd", xpbd_of);
    const std::string reason =
        "XPBD on the proxy alone differs by millimetres where rounding changes which contacts hold";
    result.exceptions = {{Promise::yaw_equivariance, reason},
                         {Promise::translation_equivariance, reason}};
    return result;
}

INSTANTIATE_TEST_SUITE_P(Embedded, StepperContract,
                         ::testing::Values(embedded("QuasiNewton5", five_iterations),
                                           embedded("Detail2", five_iterations, 2),
                                           embedded_xpbd()),
                         case_name);

constexpr double h = 1.0 / 30.0;

/// A sheet of 0.5 m and 900 vertices in the plane y = 0 that follows one of 120.
struct Follower {
    Garment fine;
    Proxy proxy;
    EmbeddedStepper stepper;

    explicit Follower(std::vector<int> pins = {}, const GoalLimits& limits = {},
                      const EmbeddedStepperSettings& settings = {},
                      const std::shared_ptr<StepStart>& detail = nullptr)
        : fine(Garment("sheet", make_sheet(0.5, 0.5, 900), Fabric::soft_cotton(), std::move(pins))
                   .with_goals(limits)),
          proxy(std::make_shared<const Garment>(make_proxy(fine, {120}))),
          stepper(fine, proxy, five_iterations(*proxy), settings, detail) {}

    static Boundary boundary() {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        return boundary;
    }
    static Boundary weightless() {
        Boundary boundary = Follower::boundary();
        boundary.gravity.setZero();
        return boundary;
    }
    /// From where the proxy alone would put it (m).
    double distance_to_embedding(const ClothState& state) const {
        Points x;
        MeshEmbedding(proxy->rest(), fine.rest()).positions(stepper.proxy_state().x, x);
        return (state.x - x).rowwise().norm().maxCoeff();
    }
    StepReport step(const Boundary& boundary, ClothState& state) {
        return stepper.step(boundary, h, state);
    }
};

/// Height of wrinkles 5 mm high and 6 cm long, finer than the proxy's edges.
double wrinkle(double x) {
    return 5e-3 * std::sin(2.0 * M_PI * x / 0.06);
}

double depth_of(const Boundary& boundary, const Points& x) {
    VectorX distance;
    Proximity().signed_distance(x, boundary, StepEnd::end, distance);
    return -distance.minCoeff();
}

/// Adds the same to each vertex's place (m).
class ShiftingStart : public StepStart {
 public:
    explicit ShiftingStart(const Vec3& by) : m_by(by) {}
    std::string name() const override { return "shifting"; }
    double fixed_dt() const override { return h; }
    bool predict(const ClothState&, const Boundary&, const IncrementalPotential&,
                 const Points& guess, PotentialValue&, Points& prediction, StageTimes&) override {
        prediction = guess.rowwise() + m_by.transpose();
        return false;
    }

 private:
    Vec3 m_by;
};

/// A sheet that hangs from a corner above a ball, after so many steps.
struct Draped {
    Follower follower;
    ClothState state;
    Boundary boundary = Follower::boundary();

    explicit Draped(int steps, const EmbeddedStepperSettings& settings = {},
                    const std::shared_ptr<StepStart>& detail = nullptr)
        : follower({0}, {}, settings, detail), state(ClothState::at_rest(follower.fine)) {
        boundary.pin_targets = rows_of(state.x, follower.fine.pins());
        boundary.obstacles.push_back(sphere({0.02, -0.13, 0.01}, 0.12));
        for (int k = 0; k < steps; ++k) follower.step(boundary, state);
    }
};

/// E of the fine garment's step from `state` to `x` (J).
double energy_of(const Draped& draped, const ClothState& state, const Points& x) {
    IncrementalPotential potential(draped.follower.fine);
    SurfaceContacts contacts;
    Proximity().query(state.x, draped.boundary, contacts);
    potential.begin_step(state, draped.boundary, contacts, h);
    return potential.value(x);
}

}  // namespace

TEST(EmbeddedStepper, IsCalledAfterTheSolverAndTheProxy) {
    const Follower follower;
    EXPECT_EQ(follower.stepper.name(),
              "quasi-newton-5~" + std::to_string(follower.proxy->vertex_count()));
}

TEST(EmbeddedStepper, TheFineGarmentFollowsTheProxy) {
    Follower follower({0});
    ClothState state = ClothState::at_rest(follower.fine);
    Boundary boundary = Follower::boundary();
    boundary.pin_targets = rows_of(state.x, follower.fine.pins());
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(follower.step(boundary, state).finite);
    EXPECT_GT((state.x - follower.fine.rest().vertices).rowwise().norm().maxCoeff(), 0.3)
        << "the scene is no test";
    EXPECT_LT(follower.distance_to_embedding(state), 1e-4);
}

TEST(EmbeddedStepper, WhatTheProxyCannotShowFadesAndDoesNotJump) {
    Follower follower;
    ClothState state = ClothState::at_rest(follower.fine);
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) state.x(i, 1) = wrinkle(state.x(i, 0));
    const ClothState wrinkled = state;
    ASSERT_TRUE(follower.step(Follower::weightless(), state).finite);
    EXPECT_LT((state.x - wrinkled.x).rowwise().norm().maxCoeff(), 5e-3)
        << "a third of the height fades, and the proxy flattens what it has of it";
    EXPECT_GT(state.x.col(1).maxCoeff(), 2e-3);
    for (int k = 0; k < 30; ++k) follower.step(Follower::weightless(), state);
    EXPECT_LT(follower.distance_to_embedding(state), 1e-5);

    EmbeddedStepperSettings at_once;
    at_once.fade = 0.0;
    Follower other({}, {}, at_once);
    state = wrinkled;
    ASSERT_TRUE(other.step(Follower::weightless(), state).finite);
    EXPECT_LT(other.distance_to_embedding(state), 1e-12);
}

TEST(EmbeddedStepper, DetailLowersTheFineGarmentsOwnEnergy) {
    const ClothState start = Draped(8).state;
    std::vector<double> energy;
    for (const int iterations : {0, 1, 3, 300}) {
        Draped draped(0, with_detail(iterations));
        ClothState state = start;
        ASSERT_TRUE(draped.follower.step(draped.boundary, state).finite);
        EXPECT_LE(depth_of(draped.boundary, state.x), 0.0);
        energy.push_back(energy_of(draped, start, state.x));
    }
    const double least = energy[3];
    EXPECT_GT(energy[0] - least, 0.0);
    EXPECT_LT(energy[1] - least, 0.3 * (energy[0] - least));
    EXPECT_LT(energy[2] - least, 0.8 * (energy[1] - least));
}

TEST(EmbeddedStepper, ManyIterationsOfDetailAreTheFineGarmentsOwnStep) {
    const ClothState start = Draped(8).state;
    Draped draped(0, with_detail(500));
    ClothStepper own(draped.follower.fine,
                     ClothStepperSettings::plain(IterationLimits::exactly(500)));
    ClothState state = start, expected = start;
    ASSERT_TRUE(draped.follower.step(draped.boundary, state).finite);
    ASSERT_TRUE(own.step(draped.boundary, h, expected).finite);
    EXPECT_LT((state.x - expected.x).rowwise().norm().maxCoeff(), 1e-4);
    EXPECT_GT(draped.follower.distance_to_embedding(state), 1e-3) << "the scene is no test";
}

TEST(EmbeddedStepper, ANetworkIsHeardWhereIterationsFollowOnlyIfItLowersTheEnergy) {
    const auto bad = std::make_shared<ShiftingStart>(Vec3(0.01, 0.0, 0.0));
    Draped with(4, with_detail(1), bad), without(4, with_detail(1));
    EXPECT_TRUE(same_bits(with.state, without.state));
    const StepReport report = with.follower.step(with.boundary, with.state);
    EXPECT_TRUE(report.prediction_rejected);
    EXPECT_EQ(with.follower.stepper.fixed_dt(), h);
    EXPECT_EQ(without.follower.stepper.fixed_dt(), 0.0);
    EXPECT_NE(with.follower.stepper.name().find("+shifting+1"), std::string::npos)
        << with.follower.stepper.name();

    Draped alone(4, with_detail(0), bad);
    const auto middle = [](const Draped& draped) { return draped.state.x.col(0).mean(); };
    EXPECT_GT(middle(alone), middle(without) + 5e-3) << "alone it is taken as it is";

    Draped halved(0, with_detail(0), bad), plain(0);
    for (int k = 0; k < 4; ++k) {
        halved.follower.stepper.step(halved.boundary, 0.5 * h, halved.state);
        plain.follower.stepper.step(plain.boundary, 0.5 * h, plain.state);
    }
    EXPECT_NEAR(middle(halved), middle(plain), 1e-3) << "it is not asked for other time steps";
}

TEST(EmbeddedStepper, IterationsAreLimitedForTheProxyAndItsDetail) {
    Draped draped(4, with_detail(7));
    EXPECT_EQ(draped.follower.step(draped.boundary, draped.state).iterations, 5 + 7);
    EXPECT_TRUE(draped.follower.stepper.set_max_iterations(2));
    EXPECT_EQ(draped.follower.step(draped.boundary, draped.state).iterations, 2 + 2);
}

TEST(EmbeddedStepper, DetailStaysWithinAnEdgeOfTheProxy) {
    const auto far = std::make_shared<ShiftingStart>(Vec3(0.0, 0.0, 3.0));
    Draped draped(6, with_detail(0), far);
    const double edge = draped.follower.proxy->mean_edge_length();
    EXPECT_GT(draped.follower.distance_to_embedding(draped.state), 0.5 * edge);
    EXPECT_LT(draped.follower.distance_to_embedding(draped.state), 1.5 * edge)
        << "where contact projection moves it";
}

TEST(EmbeddedStepper, DetailThatIsNotFiniteIsLeftOut) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto broken = std::make_shared<ShiftingStart>(Vec3(nan, 0.0, 0.0));
    Draped draped(4, with_detail(0), broken), plain(4);
    EXPECT_LT((draped.state.x - plain.state.x).rowwise().norm().maxCoeff(), 3e-3)
        << "where the proxy shows it, at the distance of contact";
    EXPECT_TRUE(draped.follower.step(draped.boundary, draped.state).prediction_rejected);
}

TEST(EmbeddedStepper, WhatIsShownFromAStateDependsOnThatAlone) {
    Draped draped(5), fresh(0);
    Points x, again, of_fresh;
    ASSERT_TRUE(draped.follower.stepper.shown_from(draped.boundary, h, draped.state, x));
    ASSERT_TRUE(draped.follower.stepper.shown_from(draped.boundary, h, draped.state, again));
    ASSERT_TRUE(fresh.follower.stepper.shown_from(draped.boundary, h, draped.state, of_fresh));
    EXPECT_EQ(x, again);
    EXPECT_EQ(x, of_fresh);
    EXPECT_GT((x - draped.state.x).rowwise().norm().maxCoeff(), 1e-3);
    Boundary bad = draped.boundary;
    bad.gravity[0] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(draped.follower.stepper.shown_from(bad, h, draped.state, again));
    EXPECT_EQ(x, again);
}

TEST(EmbeddedStepper, AStateThatWasMovedGoesOnFromThere) {
    Follower here({0}), there({0});
    ClothState state = ClothState::at_rest(here.fine), moved = state;
    Boundary boundary = Follower::boundary();
    boundary.pin_targets = rows_of(state.x, here.fine.pins());
    for (int k = 0; k < 10; ++k) {
        here.step(boundary, state);
        there.step(boundary, moved);
    }
    ASSERT_TRUE(same_bits(state, moved));
    const Vec3 by(3.0, 1.0, -2.0);
    Boundary elsewhere = boundary;
    elsewhere.pin_targets.rowwise() += by.transpose();
    moved.x.rowwise() += by.transpose();
    for (int k = 0; k < 3; ++k) {
        here.step(boundary, state);
        ASSERT_TRUE(there.step(elsewhere, moved).finite);
        const Points back = moved.x.rowwise() - by.transpose();
        // What the proxy has of the shape is read from the fine mesh there.
        EXPECT_LT((back - state.x).rowwise().norm().maxCoeff(), 5e-3) << k;
    }
}

TEST(EmbeddedStepper, AVelocityThatWasChangedIsGivenToTheProxy) {
    Follower still, pushed;
    ClothState a = ClothState::at_rest(still.fine), b = a;
    for (int k = 0; k < 3; ++k) {
        still.step(Follower::boundary(), a);
        pushed.step(Follower::boundary(), b);
    }
    const Vec3 push(0.3, 0.1, -0.2);
    b.v.rowwise() += push.transpose();
    for (int k = 1; k < 4; ++k) {
        still.step(Follower::boundary(), a);
        pushed.step(Follower::boundary(), b);
        const Points expected = a.x.rowwise() + k * h * push.transpose();
        EXPECT_LT((b.x - expected).rowwise().norm().maxCoeff(), 1e-6) << k;
    }
}

TEST(EmbeddedStepper, NoFineVertexIsInsideAndTheReportSaysWhatIsShown) {
    Follower follower;
    ClothState state = ClothState::at_rest(follower.fine);
    Boundary boundary = Follower::boundary();
    boundary.obstacles.push_back(sphere({0.02, -0.13, 0.01}, 0.12));
    Proximity proximity;
    for (int k = 0; k < 20; ++k) {
        const StepReport report = follower.step(boundary, state);
        ASSERT_TRUE(report.finite);
        EXPECT_LE(depth_of(boundary, state.x), 0.0) << k;
        const double depth =
            measure_penetration(proximity, boundary, follower.fine, state.x).max_depth;
        EXPECT_NEAR(report.max_penetration, depth, 7e-4) << k;
        EXPECT_FALSE(report.residual) << "that of another garment";
    }
    EXPECT_LT(state.x.col(1).minCoeff(), -0.1) << "it does not drape";
}

TEST(EmbeddedStepper, VerticesAloneAreKeptOutIfAsked) {
    EmbeddedStepperSettings settings;
    settings.surface = false;
    Follower follower({}, {}, settings), whole;
    ClothState state = ClothState::at_rest(follower.fine), other = state;
    Boundary boundary = Follower::boundary();
    boundary.obstacles.push_back(sphere({0.02, -0.03, 0.01}, 0.02));
    Proximity proximity;
    double deepest = 0.0, deepest_whole = 0.0;
    for (int k = 0; k < 20; ++k) {
        const StepReport report = follower.step(boundary, state);
        whole.step(boundary, other);
        ASSERT_LE(depth_of(boundary, state.x), 0.0) << k;
        EXPECT_EQ(report.max_penetration, 0.0) << k;
        const auto depth = [&](const Points& x) {
            return measure_penetration(proximity, boundary, follower.fine, x).max_depth;
        };
        deepest = std::max(deepest, depth(state.x));
        deepest_whole = std::max(deepest_whole, depth(other.x));
    }
    EXPECT_GT(deepest, deepest_whole) << "of edges and faces";
}

/// Keeps what it is told.
class Told : public Stepper {
 public:
    explicit Told(bool& surface) : m_surface(&surface) {}
    std::string name() const override { return "told"; }
    StepReport step(const Boundary&, double, ClothState&) override { return {}; }
    bool set_surface_projection(bool on) override {
        *m_surface = on;
        return true;
    }

 private:
    bool* m_surface;
};

TEST(EmbeddedStepper, TheProxysFacesAreKeptOutUnlessAskedNotTo) {
    const Follower follower;
    for (const bool asked : {true, false}) {
        EmbeddedStepperSettings settings;
        settings.proxy_surface = asked;
        bool surface = !asked;
        const EmbeddedStepper stepper(follower.fine, follower.proxy,
                                      std::make_unique<Told>(surface), settings);
        EXPECT_EQ(surface, asked);
    }
    EXPECT_TRUE(EmbeddedStepperSettings().proxy_surface);
}

TEST(EmbeddedStepper, IgnoredSolidsArePassedThroughAndReported) {
    Follower follower;
    ClothState state = ClothState::at_rest(follower.fine);
    Boundary boundary = Follower::boundary();
    boundary.obstacles.push_back(sphere({0.02, -0.13, 0.01}, 0.12));
    boundary.obstacles[0].solid = 4;
    boundary.ignored_limbs.assign(static_cast<size_t>(follower.fine.vertex_count()), 4);
    for (int k = 0; k < 8; ++k) ASSERT_TRUE(follower.step(boundary, state).finite);
    const double fall = state.x.col(1).mean();
    EXPECT_NEAR(fall, -0.5 * 8 * 9 * h * h * 9.81, 1e-3) << "it falls as if nothing were there";
}

TEST(EmbeddedStepper, FineVerticesKeepToTheirOwnGoals) {
    const TriMesh mesh = make_sheet(0.5, 0.5, 900);
    GoalLimits limits;
    limits.max_distance = 0.02 + 0.1 * (mesh.vertices.col(0).array() + 0.25);
    for (const int detail : {0, 2}) {
        Follower follower({}, limits, with_detail(detail));
        ClothState state = ClothState::at_rest(follower.fine);
        Boundary boundary = Follower::boundary();
        for (int k = 0; k < 20; ++k) {
            boundary.goals = SkinGoals::at(mesh.vertices);
            boundary.goals.x0.col(2).array() += 0.02 * k;
            boundary.goals.x1.col(2).array() += 0.02 * (k + 1);
            const StepReport report = follower.step(boundary, state);
            ASSERT_TRUE(report.finite);
            EXPECT_EQ(report.vertices_beyond_goals, 0);
            const VectorX far = (state.x - boundary.goals.x1).rowwise().norm();
            EXPECT_LE((far - limits.max_distance).maxCoeff(), 1e-9) << k;
        }
        EXPECT_LT(state.x.col(1).minCoeff(), -0.03) << "it does not hang";
    }
}

TEST(EmbeddedStepper, AFailedStepOfTheProxyLeavesEverything) {
    Follower follower;
    ClothState state = ClothState::at_rest(follower.fine);
    ASSERT_TRUE(follower.step(Follower::boundary(), state).finite);
    const ClothState before = state;
    Boundary bad = Follower::boundary();
    bad.gravity[0] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(follower.step(bad, state).finite);
    EXPECT_TRUE(same_bits(state, before));
    Follower other;
    ClothState twin = ClothState::at_rest(other.fine);
    other.step(Follower::boundary(), twin);
    follower.step(Follower::boundary(), state);
    other.step(Follower::boundary(), twin);
    EXPECT_TRUE(same_bits(state, twin));
}

TEST(EmbeddedStepper, BadInputIsRefusedByName) {
    const Garment fine("flag", make_sheet(0.5, 0.5, 900), Fabric::soft_cotton());
    const auto pinned =
        std::make_shared<const Garment>(fine.name() + " proxy", make_sheet(0.5, 0.5, 120),
                                        Fabric::soft_cotton(), std::vector<int>{0});
    const auto away = std::make_shared<const Garment>("away", sheet(5, 0.5), Fabric::soft_cotton());
    const auto make = [&](const Proxy& proxy, bool with_stepper, double fade = 0.1) {
        EmbeddedStepperSettings settings;
        settings.fade = fade;
        return refusal([&] {
            EmbeddedStepper(fine, proxy, with_stepper ? five_iterations(*proxy) : nullptr,
                            settings);
        });
    };
    const auto good = std::make_shared<const Garment>(make_proxy(fine, {120}));
    EXPECT_EQ(make(good, true), "");
    const std::string iterations =
        refusal([&] { EmbeddedStepper(fine, good, five_iterations(*good), with_detail(-1)); });
    EXPECT_NE(iterations.find("detail_iterations"), std::string::npos) << iterations;
    for (const auto& [text, word] :
         {std::pair(make(nullptr, false), "no proxy"), std::pair(make(good, false), "no stepper"),
          std::pair(make(pinned, true), "pins, or goals"),
          std::pair(make(good, true, 11.0), "fade"),
          std::pair(make(away, true), "from the coarse mesh")}) {
        EXPECT_NE(text.find(word), std::string::npos) << text;
        EXPECT_NE(text.find("Remedy"), std::string::npos) << text;
    }
    // A coarse mesh without a vertex near the pin in the middle of the sheet.
    Eigen::Index middle = 0;
    fine.rest().vertices.rowwise().norm().minCoeff(&middle);
    const std::string text = refusal([&] {
        carry_over(fine.with_pins({static_cast<int>(middle)}), make_sheet(0.5, 0.5, 120), "loose");
    });
    for (const char* word : {"loose: pin", "of flag", "hang from nothing", "Remedy"})
        EXPECT_NE(text.find(word), std::string::npos) << text;
}

}  // namespace cloth::test
