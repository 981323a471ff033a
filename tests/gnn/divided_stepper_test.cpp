#include "gnn/physics/stepper/divided_stepper.h"

#include <string>
#include <utility>

#include "data/core/errors.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/gnn/stepper_contract.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

constexpr double h = 1.0 / 30.0;

std::unique_ptr<Stepper> five_iterations(const Garment& garment) {
    return std::make_unique<ClothStepper>(garment,
                                          ClothStepperSettings::plain(IterationLimits::exactly(5)));
}

std::unique_ptr<Stepper> default_cloth(const Garment& garment) {
    return std::make_unique<ClothStepper>(garment);
}

std::unique_ptr<Stepper> xpbd_of(const Garment& garment) {
    return std::make_unique<XpbdStepper>(garment);
}

StepperCase divided(const std::string& name,
                    std::unique_ptr<Stepper> (*make_stepper)(const Garment&), int parts) {
    const auto make = [=](const Garment& garment) -> std::unique_ptr<Stepper> {
        return std::make_unique<DividedStepper>(garment, make_stepper(garment), parts);
    };
    return {name, make, 1e-6, {{Promise::free_fall, "it falls as shorter steps do"}}};
}

StepperCase divided_xpbd() {
    StepperCase result = divided("XpbdIn2", xpbd_of, 2);
    result.exceptions[Promise::permutation_invariance] =
        "XPBD takes its constraints one after the other";
    for (const Promise promise : {Promise::yaw_equivariance, Promise::translation_equivariance})
        result.exceptions[promise] =
            "where rounding changes which contacts hold, XPBD differs by millimetres";
    return result;
}

INSTANTIATE_TEST_SUITE_P(Divided, StepperContract,
                         ::testing::Values(divided("QuasiNewton5In2", five_iterations, 2),
                                           divided("DefaultIn3", default_cloth, 3), divided_xpbd()),
                         case_name);

/// The busy scene with its ball and pins on the move from time to time + dt.
Boundary at(const SolverScene& scene, double time, double dt) {
    const Vec3 ball(0.2, 0.6, -0.1), pins(0.1, 0.3, 0.4);  // m/s
    Boundary boundary = scene.boundary;
    boundary.obstacles[0].pose0.translation() += time * ball;
    boundary.obstacles[0].pose1.translation() += (time + dt) * ball;
    boundary.pin_targets.rowwise() += (time + dt) * pins.transpose();
    return boundary;
}

double farthest(const Points& a, const Points& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

/// Says what it was asked for, moves each vertex by its velocity, and fails in a part if asked to.
class Recorder : public Stepper {
 public:
    std::string name() const override { return "recorder"; }
    double fixed_dt() const override { return 0.01; }
    bool accepts_any_dt() const override { return false; }
    void prepare(double dt) override { prepared = dt; }
    bool set_max_ms(double ms) override {
        max_ms = ms;
        return true;
    }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override {
        if (++steps == fail_at) return StepReport::failed();
        shared_trees = shared_trees || boundary.trees;
        state.v *= 2.0;
        state.x += dt * state.v;
        state.time += dt;
        StepReport report;
        report.iterations = steps;
        report.substeps = steps == 1 ? 4 : 1;
        report.max_penetration = 0.1 * steps;
        report.max_entry = 0.1 / steps;
        report.converged = steps > 1;
        report.prediction_rejected = steps == 1;
        report.times.solve = 1.0;
        return report;
    }
    bool internal_forces(const Points& x, Points& forces) const override {
        forces = x;
        return true;
    }

    int steps = 0, fail_at = 0;
    double prepared = 0.0, max_ms = 0.0;
    bool shared_trees = false;
};

/// Three parts of a Recorder's steps, on a free sheet that moves at 1 m/s.
struct Recorded {
    Garment garment{"sheet", sheet(4, 0.5), Fabric::soft_cotton()};
    Recorder* recorder;
    DividedStepper stepper;
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;

    explicit Recorded(std::unique_ptr<Recorder> made = std::make_unique<Recorder>())
        : recorder(made.get()), stepper(garment, std::move(made), 3) {
        state.v.col(0).setOnes();
        boundary.pin_targets.resize(0, 3);
    }
};

}  // namespace

TEST(DividedStepper, TakesTheStepsOfTheOtherOneByOne) {
    const SolverScene scene = busy_scene();
    for (const auto make : {five_iterations, default_cloth, xpbd_of}) {
        const std::unique_ptr<Stepper> by_hand = make(scene.garment);
        DividedStepper stepper(scene.garment, make(scene.garment), 2);
        ClothState expected = scene.state, state = scene.state;
        // Parts move evenly but for rounding, by which XPBD soon differs in contact.
        const int steps = make == xpbd_of ? 2 : 6;
        for (int k = 0; k < steps; ++k) {
            const Points before = state.x;
            for (int part = 0; part < 2; ++part)
                by_hand->step(at(scene, (2 * k + part) * h, h), h, expected);
            ASSERT_TRUE(stepper.step(at(scene, 2 * k * h, 2 * h), 2 * h, state).finite);
            EXPECT_LT(farthest(state.x, expected.x), 1e-6) << by_hand->name() << ", step " << k;
            EXPECT_LT(farthest(state.v, (state.x - before) / (2 * h)), 1e-12);
            EXPECT_NEAR(state.time, 2 * (k + 1) * h, 1e-12);
        }
        EXPECT_GT(farthest(state.x, scene.state.x), steps < 6 ? 0.02 : 0.05)
            << "the scene is no test";
    }
}

TEST(DividedStepper, GoesOnFromTheVelocityOfTheLastPartAndWhatWasAddedToTheMean) {
    Recorded r;
    r.stepper.step(r.boundary, 0.03, r.state);  // parts at 2, 4 and 8 m/s
    EXPECT_NEAR(r.state.v(0, 0), 14.0 / 3.0, 1e-12);
    const ClothState first = r.state;
    r.stepper.step(r.boundary, 0.03, r.state);  // 16, 32, 64
    EXPECT_NEAR(r.state.v(0, 0), 112.0 / 3.0, 1e-10);
    r.state = first;  // once more from where the last step began
    r.state.v.col(0).array() += 1.0;
    r.stepper.step(r.boundary, 0.03, r.state);  // 18, 36, 72
    EXPECT_NEAR(r.state.v(0, 0), 126.0 / 3.0, 1e-10);
    r.state.x.col(1).array() += 1.0;  // somebody placed it: its velocity is all that it has
    r.state.v.setConstant(0.5);
    r.stepper.step(r.boundary, 0.03, r.state);  // 1, 2, 4
    EXPECT_NEAR(r.state.v(0, 0), 7.0 / 3.0, 1e-10);
}

TEST(DividedStepper, AStateThatWasMovedGoesOnTurned) {
    Recorded here, there;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix();
    for (Recorded* r : {&here, &there}) r->stepper.step(r->boundary, 0.03, r->state);
    const Points before = there.state.x;
    there.state.x = (before * turn.transpose()).eval();
    there.state.v = (there.state.v * turn.transpose()).eval();
    there.stepper.moved(before, there.state.x, turn);
    for (Recorded* r : {&here, &there}) r->stepper.step(r->boundary, 0.03, r->state);
    EXPECT_LT(farthest(there.state.x, here.state.x * turn.transpose()), 1e-12);
}

TEST(DividedStepper, ReportsThePartsTogether) {
    Recorded r;
    r.boundary.trees = std::make_shared<ObstacleTrees>();
    const StepReport report = r.stepper.step(r.boundary, 0.03, r.state);
    EXPECT_EQ(report.iterations, 1 + 2 + 3);
    EXPECT_EQ(report.substeps, 4);
    EXPECT_DOUBLE_EQ(report.max_penetration, 0.1 * 3);
    EXPECT_DOUBLE_EQ(report.max_entry, 0.1);
    EXPECT_FALSE(report.converged);
    EXPECT_TRUE(report.prediction_rejected);
    EXPECT_DOUBLE_EQ(report.times.solve, 3.0);
    EXPECT_FALSE(r.recorder->shared_trees) << "poses of parts crowd out those of the world";
}

TEST(DividedStepper, APartThatFailsFailsTheStep) {
    for (const int fail_at : {1, 2, 3}) {
        auto recorder = std::make_unique<Recorder>();
        recorder->fail_at = fail_at;
        Recorded r(std::move(recorder));
        const ClothState before = r.state;
        EXPECT_FALSE(r.stepper.step(r.boundary, 0.03, r.state).finite);
        EXPECT_TRUE(same_bits(r.state, before));
    }
}

TEST(DividedStepper, HandsOnWhatItIsTold) {
    Recorded r;
    EXPECT_EQ(r.stepper.name(), "recorderx3");
    EXPECT_NEAR(r.stepper.fixed_dt(), 0.03, 1e-15);
    EXPECT_FALSE(r.stepper.accepts_any_dt());
    r.stepper.prepare(0.06);
    EXPECT_NEAR(r.recorder->prepared, 0.02, 1e-15);
    EXPECT_TRUE(r.stepper.set_max_ms(6.0));
    EXPECT_DOUBLE_EQ(r.recorder->max_ms, 2.0);
    EXPECT_FALSE(r.stepper.set_max_iterations(2)) << "a recorder has none";
}

TEST(DividedStepper, ForcesOfTheLastStepAreTheMeanOfItsParts) {
    Recorded r;
    const Points before = r.state.x;
    r.stepper.step(r.boundary, 0.03, r.state);
    Points forces;
    ASSERT_TRUE(r.stepper.internal_forces(r.state.x, forces));
    // The parts end at 0.02, 0.06 and 0.14 m.
    EXPECT_NEAR(forces(0, 0) - before(0, 0), 0.22 / 3.0, 1e-12);
    ASSERT_TRUE(r.stepper.internal_forces(before, forces));
    EXPECT_EQ(forces, before) << "elsewhere those of the place";
}

TEST(DividedStepper, SaysWhatItCannotBeMadeOf) {
    const Garment garment("sheet", sheet(4, 0.5), Fabric::soft_cotton());
    EXPECT_NE(refusal([&] { DividedStepper(garment, nullptr, 2); }).find("there is no stepper"),
              std::string::npos);
    for (const int parts : {0, 65})
        EXPECT_NE(refusal([&] {
                      DividedStepper(garment, five_iterations(garment), parts);
                  }).find("DividedStepper.parts"),
                  std::string::npos);
}

}  // namespace cloth::test
