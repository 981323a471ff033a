#include "gnn/physics/stepper/guarded_stepper.h"

#include <gtest/gtest.h>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/quasi_newton_stepper.h"
#include "gnn/physics/stepper/watched_stepper.h"

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

/// Says how deep it went past a surface.
class Entering : public Stepper {
 public:
    explicit Entering(double entry) : m_entry(entry) {}
    std::string name() const override { return "entering"; }
    StepReport step(const Boundary& boundary, double h, ClothState& state) override {
        ignored = boundary.ignored_limbs;
        state.x.array() += 1.0;
        state.time += h;
        StepReport report;
        report.max_entry = m_entry;
        return report;
    }
    std::vector<LimbSet> ignored;

 private:
    double m_entry;
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

TEST_F(Guard, AStepThatWentPastASurfaceIsTakenAgainInSubsteps) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};  // 7 cm: not too fast by itself
    GuardedStepper guarded(m_garment, std::make_unique<Entering>(0.02));
    ClothState by_hand = m_state;
    ASSERT_TRUE(guarded.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(guarded.last_substeps(), 2);
    SubsteppedStepper(m_garment,
                      std::make_unique<QuasiNewtonStepper>(m_garment, GuardSettings().solver), 2)
        .step(m_boundary, dt, by_hand);
    EXPECT_EQ(m_state.x, by_hand.x);
    EXPECT_EQ(m_state.v, by_hand.v);
    EXPECT_DOUBLE_EQ(m_state.time, dt);
}

TEST_F(Guard, AShallowEntryAndASlowSurfaceAreTheInnersAffair) {
    const Points moved = m_state.x.array() + 1.0;
    const auto expect_inner = [&](double entry, double motion) {
        m_boundary.obstacles = {ball(-0.2, -0.2 + motion)};
        ClothState state = m_state;
        GuardedStepper guarded(m_garment, std::make_unique<Entering>(entry));
        guarded.step(m_boundary, dt, state);
        EXPECT_EQ(guarded.last_substeps(), 1);
        EXPECT_EQ(state.x, moved);
    };
    expect_inner(0.005, 0.07);
    expect_inner(0.02, 0.03);
}

/// A plate of 3 cm that moves along x.
Obstacle plate(double from, double to) {
    Obstacle box;
    box.shape = ObstacleShape::box;
    box.half_extents = Vec3(0.015, 0.2, 0.2);
    box.pose0.translation() = Vec3(from, 0, 0);
    box.pose1.translation() = Vec3(to, 0, 0);
    return box;
}

/// The same as a mesh.
Obstacle as_mesh(const Obstacle& box) {
    Obstacle mesh;
    Faces faces(12, 3);
    faces << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6,
        2, 1, 3, 7, 1, 7, 5;
    mesh.faces = std::make_shared<const Faces>(faces);
    mesh.x0.resize(8, 3);
    for (int i = 0; i < 8; ++i)
        mesh.x0.row(i) =
            box.half_extents.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    mesh.x1 = mesh.x0.rowwise() + box.pose1.translation().transpose();
    mesh.x0 = mesh.x0.rowwise() + box.pose0.translation().transpose();
    return mesh;
}

/// Flies to where it is told, through anything.
class Flying : public Stepper {
 public:
    explicit Flying(const Vec3& way) : m_way(way) {}
    std::string name() const override { return "flying"; }
    StepReport step(const Boundary&, double h, ClothState& state) override {
        state.x.rowwise() += m_way.transpose();
        state.time += h;
        return {};
    }

 private:
    Vec3 m_way;
};

class Through : public Guard, public ::testing::WithParamInterface<bool> {
 protected:
    void place(const Obstacle& box) { m_boundary.obstacles = {GetParam() ? as_mesh(box) : box}; }
};

TEST_P(Through, AStepThatWentThroughASolidIsTakenAgainInSubsteps) {
    place(plate(-0.03, 0.029));
    GuardSettings settings;
    for (const double motion : {0.01, 0.1}) {
        settings.tunnelling_motion = motion;
        GuardedStepper guarded(m_garment, std::make_unique<Flying>(Vec3(0.005, 0, 0)), settings);
        ClothState state = m_state;
        const StepReport report = guarded.step(m_boundary, dt, state);
        ASSERT_TRUE(report.finite);
        EXPECT_EQ(guarded.last_substeps(), motion < 0.015 ? 8 : 4)
            << "5.9 cm in parts of at most 1 cm, or half of the plate's 3 cm";
        EXPECT_EQ(guarded.guarded_steps(), 1);
        EXPECT_TRUE(std::isinf(report.tunnelled));
        for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
            const Vec3 rest = m_garment.rest().vertices.row(i);
            const bool in_its_way = std::max(std::abs(rest.y()), std::abs(rest.z())) < 0.19;
            EXPECT_TRUE(!in_its_way || state.x(i, 0) > 0.0439) << "vertex " << i;
        }
    }
}

TEST_P(Through, AWatcherSaysHowThickItWas) {
    place(plate(-0.03, 0.029));
    const auto passed = [&](double least_motion) {
        ClothState state = m_state;
        WatchedStepper watched(m_garment, std::make_unique<Flying>(Vec3(0.005, 0, 0)),
                               least_motion);
        const double thickness = watched.step(m_boundary, dt, state).tunnelled;
        EXPECT_EQ(watched.name(), "flying");
        EXPECT_EQ(state.x, m_state.x.rowwise() + Eigen::RowVector3d(0.005, 0, 0));
        return thickness;
    };
    EXPECT_NEAR(passed(0.02), 0.03, 1e-5);
    EXPECT_TRUE(std::isinf(passed(0.07))) << "too slow to be watched";
    place(plate(-0.09, -0.03));
    EXPECT_TRUE(std::isinf(passed(0.02))) << "stays on its side";
}

TEST_P(Through, WithoutSubstepsNothingIsWatched) {
    place(plate(-0.03, 0.029));
    GuardSettings settings;
    settings.max_substeps = 1;
    GuardedStepper guarded(m_garment, std::make_unique<Flying>(Vec3(0.005, 0, 0)), settings);
    EXPECT_TRUE(std::isinf(guarded.step(m_boundary, dt, m_state).tunnelled));
    EXPECT_EQ(guarded.last_substeps(), 1);
}

INSTANTIATE_TEST_SUITE_P(PrimitiveAndMesh, Through, ::testing::Bool(),
                         [](const auto& scene) { return scene.param ? "mesh" : "box"; });

TEST_F(Guard, AWatcherOfNothingIsRefused) {
    EXPECT_THROW(WatchedStepper(m_garment, nullptr, 0.02), ArgumentError);
}

TEST_F(Guard, AWatcherLeavesInvalidStepsToTheStepper) {
    WatchedStepper watched(m_garment, quasi_newton(m_garment), 0.02);
    const ClothState before = m_state;
    EXPECT_FALSE(watched.step(m_boundary, -1.0, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
}

TEST_F(Guard, WhenTheFinerStepFailsTheFirstOneCounts) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};
    const Points moved = m_state.x.array() + 1.0;
    GuardedStepper guarded(m_garment, std::make_unique<Entering>(0.02));
    const double too_short = 1e-200;  // for any solver: 1 / dt^2 overflows
    EXPECT_TRUE(guarded.step(m_boundary, too_short, m_state).finite);
    EXPECT_EQ(m_state.x, moved);
    EXPECT_EQ(guarded.last_substeps(), 1);
    EXPECT_EQ(guarded.guarded_steps(), 0);
}

TEST_F(Guard, SteppersSayHowDeepTheyWentPastASurface) {
    m_boundary.obstacles = {ball(-0.3, -0.05)};  // at t it is out of reach
    const StepReport report = quasi_newton(m_garment)->step(m_boundary, dt, m_state);
    EXPECT_GT(report.max_entry, 0.03);
    EXPECT_LT(report.max_entry, 0.051);
    EXPECT_LT(report.max_penetration, 1e-3);
}

/// Two squares of one body that face along x, the second 3 cm behind the first: limbs 0 and 1.
Obstacle two_skins(double width) {
    const TriMesh square = make_sheet(width, width, 100);
    const Eigen::Index count = square.vertices.rows();
    Faces faces(2 * square.faces.rows(), 3);
    faces << square.faces, square.faces.array() + static_cast<int>(count);
    auto limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(faces.rows()), 0);
    std::fill(limbs->begin() + square.faces.rows(), limbs->end(), 1);
    Obstacle body;
    body.faces = std::make_shared<const Faces>(faces);
    body.limbs = limbs;
    body.x0.resize(2 * count, 3);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 at = square.vertices.row(i);
        body.x0.row(i) << -0.01, at.z(), at.x();
        body.x0.row(count + i) << -0.04, at.z(), at.x();
    }
    body.x1 = body.x0;
    return body;
}

TEST_F(Guard, LimbsThatPassThroughOthersAreIgnored) {
    m_boundary.obstacles = {two_skins(0.3)};  // the sheet is at home on the first
    auto inner = std::make_unique<Entering>(0.0);
    const Entering& seen = *inner;
    GuardedStepper guarded(m_garment, std::move(inner));
    guarded.step(m_boundary, dt, m_state);
    ASSERT_EQ(seen.ignored.size(), size_t(m_garment.vertex_count()));
    EXPECT_EQ(seen.ignored, guarded.ignored_limbs());
    EXPECT_EQ(std::count(seen.ignored.begin(), seen.ignored.end(), LimbSet(2)),
              std::count_if(seen.ignored.begin(), seen.ignored.end(),
                            [](LimbSet set) { return set != 0; }));
    EXPECT_GT(std::count(seen.ignored.begin(), seen.ignored.end(), LimbSet(2)), 50);
}

/// Moves along x, and says nothing.
class Shifting : public Stepper {
 public:
    explicit Shifting(double shift) : m_shift(shift) {}
    std::string name() const override { return "shifting"; }
    StepReport step(const Boundary&, double, ClothState& state) override {
        state.x.col(0).array() += m_shift;
        return {};
    }

 private:
    double m_shift;
};

TEST_F(Guard, TellsHowDeepTheGarmentIsInLimbsThatItIgnores) {
    m_boundary.obstacles = {two_skins(1.2)};
    GuardedStepper guarded(m_garment, std::make_unique<Shifting>(-0.06));
    const StepReport report = guarded.step(m_boundary, dt, m_state);
    ASSERT_EQ(guarded.last_substeps(), 1);
    EXPECT_EQ(report.vertices_in_ignored_limbs, m_garment.vertex_count());
    EXPECT_NEAR(report.max_ignored_depth, 0.02, 1e-9);

    m_state = ClothState::at_rest(m_garment);
    GuardedStepper clear(m_garment, std::make_unique<Shifting>(-0.03));
    EXPECT_EQ(clear.step(m_boundary, dt, m_state).vertices_in_ignored_limbs, 0);
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
    settings.max_entry = 0.0;
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
    settings = {};
    settings.fine_motion = std::nan("");
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
    settings = {};
    settings.watch_motion = 1e-3;
    EXPECT_THROW(GuardedStepper(m_garment, quasi_newton(m_garment), settings), ArgumentError);
    settings = {};
    settings.tunnelling_motion = 0.0;
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
