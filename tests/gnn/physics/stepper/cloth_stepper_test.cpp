#include "gnn/physics/stepper/cloth_stepper.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/relative_motion.h"

namespace cloth::cloth_stepper_test {
namespace {

constexpr double dt = 1.0 / 30.0;

/// Solvers of which the whole step is a stand-in; parts are the real solver's, or fail.
class Standing : public StepSolver {
 public:
    explicit Standing(const Garment& garment, const StepSettings& settings = StepSettings::whole())
        : StepSolver(garment, settings) {}
    StepReport part(const Boundary& boundary, double h, const IterationLimits& limits,
                    ClothState& state) override {
        return parts_fail ? StepReport::failed() : StepSolver::part(boundary, h, limits, state);
    }
    StepReport correct(const Boundary& boundary, double h, const TunnellingDetector* through,
                       const IterationLimits& limits, ClothState& state) override {
        return corrections_fail ? StepReport::failed()
                                : StepSolver::correct(boundary, h, through, limits, state);
    }
    bool parts_fail = false, corrections_fail = false;
};

class Failing : public Standing {
 public:
    using Standing::Standing;
    StepReport whole(const Boundary&, double, ClothState&) override { return StepReport::failed(); }
};

/// Says how deep it went past a surface.
class Entering : public Standing {
 public:
    Entering(const Garment& garment, double entry,
             const StepSettings& settings = StepSettings::whole())
        : Standing(garment, settings), m_entry(entry) {}
    StepReport in_small_steps(int count, const Boundary& boundary, double h, From from,
                              ClothState& state) override {
        const Points moved = state.x.array() + 1.0;
        StepReport report = StepSolver::in_small_steps(count, boundary, h, from, state);
        state.x = moved;
        report.max_entry = m_entry;
        return report;
    }
    StepReport whole(const Boundary& boundary, double h, ClothState& state) override {
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

/// Flies to where it is told, through anything.
class Flying : public Standing {
 public:
    Flying(const Garment& garment, const Vec3& way) : Standing(garment), m_way(way) {}
    StepReport whole(const Boundary&, double h, ClothState& state) override {
        state.x.rowwise() += m_way.transpose();
        state.time += h;
        return {};
    }

 private:
    Vec3 m_way;
};

ClothStepperSettings plain() {
    return ClothStepperSettings::plain(IterationLimits::exactly(10));
}

ClothStepperSettings guarded(const GuardSettings& guard = {}) {
    ClothStepperSettings settings = plain();
    settings.guard = guard;
    return settings;
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
    static GuardSettings entries_of_a_centimetre() {
        GuardSettings settings;
        settings.max_entry = 0.01;
        return settings;
    }
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

TEST_F(Guard, AStepThatNeedsNoPartsIsTheSolvers) {
    m_boundary.obstacles = {ball(-0.15, -0.12)};
    ClothState alone = m_state;
    ClothStepper inner(m_garment, plain()), stepper(m_garment, guarded());
    for (int k = 0; k < 3; ++k) {
        inner.step(m_boundary, dt, alone);
        EXPECT_EQ(stepper.step(m_boundary, dt, m_state).substeps, 1);
        m_boundary.obstacles = {ball(-0.12 + 0.03 * k, -0.09 + 0.03 * k)};
    }
    EXPECT_EQ(m_state.x, alone.x);
    EXPECT_EQ(m_state.v, alone.v);
}

TEST_F(Guard, AFastBallCarriesTheSheetInsteadOfPassingThrough) {
    // 12 m/s: 40 cm in a frame
    m_boundary.obstacles = {ball(-0.3, 0.1)};
    ClothState alone = m_state;
    ClothStepper(m_garment, plain()).step(m_boundary, dt, alone);
    ClothStepper stepper(m_garment, guarded());
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    ASSERT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 4);
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
    const StepReport report = ClothStepper(pinned, guarded()).step(m_boundary, dt, m_state);
    ASSERT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 4);
    EXPECT_EQ(m_state.x.row(0), m_boundary.pin_targets.row(0));
}

/// A sheet that hangs by one edge and swings about it: the free end is twice as fast as the mean.
struct Swinging {
    explicit Swinging(const TriMesh& mesh, double mean_motion)
        : garment("sheet", mesh, Fabric::soft_cotton(), upper_edge(mesh)),
          state(ClothState::at_rest(garment)) {
        state.v.col(0) = (2.0 * mean_motion / 0.8 / dt) * (0.4 - state.x.col(2).array());
        boundary.pin_targets.resize(static_cast<Eigen::Index>(garment.pins().size()), 3);
        for (size_t p = 0; p < garment.pins().size(); ++p)
            boundary.pin_targets.row(static_cast<Eigen::Index>(p)) = state.x.row(garment.pins()[p]);
    }
    static std::vector<int> upper_edge(const TriMesh& mesh) {
        std::vector<int> pins;
        for (int i = 0; i < static_cast<int>(mesh.vertices.rows()); ++i)
            if (mesh.vertices(i, 2) > 0.399) pins.push_back(i);
        return pins;
    }
    double motion() const { return relative_motion(garment, boundary, dt, state); }

    Garment garment;
    ClothState state;
    Boundary boundary;
};

TEST_F(Guard, ASheetThatSwingsFromItsPinsIsNotFast) {
    Swinging swinging(upright(), 0.15);
    ASSERT_GT(swinging.garment.pins().size(), 5u);
    EXPECT_LT(swinging.motion(), 0.03) << "the pins, over the vertices next to them";
    Obstacle ground;
    ground.shape = ObstacleShape::plane;
    ground.pose0.translation().y() = ground.pose1.translation().y() = -3.0;
    swinging.boundary.obstacles = {ground};
    EXPECT_LT(swinging.motion(), 0.03) << "nothing of it can reach the ground";
    ground.pose0.translation().y() = ground.pose1.translation().y() = -0.45;
    swinging.boundary.obstacles = {ground};
    EXPECT_NEAR(swinging.motion(), 0.15, 0.01);
}

TEST_F(Guard, WhatTheFreeEndOfASwingingSheetMayHitIsFast) {
    Swinging swinging(upright(), 0.15);
    Obstacle sphere = ball(0.25, 0.25);
    sphere.pose0.translation().z() = sphere.pose1.translation().z() = -0.4;
    swinging.boundary.obstacles = {sphere};
    EXPECT_NEAR(swinging.motion(), 0.15, 0.01);
}

TEST_F(Guard, AFailedStepIsMadeInParts) {
    ClothStepper stepper(m_garment, std::make_unique<Failing>(m_garment));
    m_boundary.gravity = Vec3(0, -9.81, 0);
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    ASSERT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 2);
    EXPECT_LT(m_state.x.col(1).mean(), m_garment.rest().vertices.col(1).mean());
    EXPECT_DOUBLE_EQ(m_state.time, dt);
}

TEST_F(Guard, AStepThatWentPastASurfaceIsTakenAgainInSubsteps) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};  // 7 cm: not too fast by itself
    ClothStepper stepper(m_garment, std::make_unique<Entering>(m_garment, 0.02),
                         entries_of_a_centimetre());
    ClothState by_hand = m_state;
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    ASSERT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 2);
    ClothStepperSettings halves = ClothStepperSettings::plain(GuardSettings().iterations);
    halves.substeps = 2;
    ClothStepper(m_garment, halves).step(m_boundary, dt, by_hand);
    EXPECT_EQ(m_state.x, by_hand.x);
    EXPECT_EQ(m_state.v, by_hand.v);
    EXPECT_DOUBLE_EQ(m_state.time, dt);
}

TEST_F(Guard, StepsInSmallOnesAreFineEnoughForEntries) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};
    m_state.v.col(1).setOnes();
    const Points moved = m_state.x.array() + 1.0;
    auto solver = std::make_unique<Entering>(m_garment, 0.02, StepSettings::in_small_steps());
    solver->corrections_fail = true;
    ClothStepper stepper(m_garment, std::move(solver), entries_of_a_centimetre());
    EXPECT_EQ(stepper.step(m_boundary, dt, m_state).substeps, 1);
    EXPECT_EQ(m_state.x, moved);
}

/// Cloth at rest takes whole steps.
TEST_F(Guard, ClothAtRestIsCutForEntriesHoweverItsSolverStepsOtherwise) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};
    ClothStepper stepper(
        m_garment, std::make_unique<Entering>(m_garment, 0.02, StepSettings::in_small_steps()),
        entries_of_a_centimetre());
    EXPECT_GT(stepper.step(m_boundary, dt, m_state).substeps, 1);
}

TEST_F(Guard, AShallowEntryAndASlowSurfaceAreTheSolversAffair) {
    const Points moved = m_state.x.array() + 1.0;
    const auto expect_inner = [&](double entry, double motion) {
        m_boundary.obstacles = {ball(-0.2, -0.2 + motion)};
        ClothState state = m_state;
        ClothStepper stepper(m_garment, std::make_unique<Entering>(m_garment, entry),
                             entries_of_a_centimetre());
        EXPECT_EQ(stepper.step(m_boundary, dt, state).substeps, 1);
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

TEST_F(Guard, AFaceIsFastWhereNoCornerOfItIsNear) {
    m_boundary.obstacles = {as_mesh(plate(0.03, -0.03))};
    m_boundary.obstacles[0].x0.rightCols(2) *= 100.0;
    m_boundary.obstacles[0].x1.rightCols(2) *= 100.0;
    EXPECT_NEAR(relative_motion(m_garment, m_boundary, dt, m_state), 0.06, 1e-12);
    m_boundary.obstacles = {as_mesh(plate(5.0, 4.9))};
    EXPECT_EQ(relative_motion(m_garment, m_boundary, dt, m_state), 0.0);
}

/// A finger of 14 mm that comes as far out of the middle of a face, where nothing but contact moves
/// the sheet.
TEST_F(Guard, AFingerCarriesTheFaceThatItPierced) {
    const Points& rest = m_garment.rest().vertices;
    const Faces& faces = m_garment.rest().faces;
    const double tip = 0.014;
    int pierced = 0;
    for (int face = 400; face < 700; face += 20) {
        const auto centre = [&](const Points& x) -> Vec3 {
            return (x.row(faces(face, 0)) + x.row(faces(face, 1)) + x.row(faces(face, 2))) / 3.0;
        };
        Obstacle box;
        box.shape = ObstacleShape::box;
        box.half_extents = {0.1, 0.007, 0.007};
        box.pose0.translation() = centre(rest) + Vec3(-0.01 - 0.1, 0, 0);
        box.pose1.translation() = centre(rest) + Vec3(tip - 0.1, 0, 0);
        m_boundary.obstacles = {as_mesh(box)};
        for (const bool watched : {true, false}) {
            GuardSettings guard;
            if (!watched) guard.max_substeps = 1;
            ClothStepperSettings settings = guarded(guard);
            settings.step = StepSettings::whole(IterationLimits::none());
            ClothStepper stepper(m_garment, settings);
            ClothState state = m_state;
            const StepReport report = stepper.step(m_boundary, dt, state);
            if (watched) {
                EXPECT_LT(report.max_penetration, 1e-3) << face;
                EXPECT_GT(centre(state.x).x(), tip - 1e-3) << face;
            } else if (centre(state.x).x() < 0.5 * tip) {
                ++pierced;
            }
        }
    }
    EXPECT_GT(pierced, 3) << "else this tests nothing";
}

class Through : public Guard, public ::testing::WithParamInterface<bool> {
 protected:
    void place(const Obstacle& box) { m_boundary.obstacles = {GetParam() ? as_mesh(box) : box}; }
};

TEST_P(Through, AStepThatWentThroughASolidIsTakenAgainInSubsteps) {
    place(plate(-0.03, 0.029));
    GuardSettings settings;
    for (const double motion : {0.01, 0.1}) {
        settings.tunnelling_motion = motion;
        ClothStepper stepper(m_garment, std::make_unique<Flying>(m_garment, Vec3(0.005, 0, 0)),
                             settings);
        ClothState state = m_state;
        const StepReport report = stepper.step(m_boundary, dt, state);
        ASSERT_TRUE(report.finite);
        EXPECT_EQ(report.substeps, motion < 0.015 ? 8 : 4)
            << "5.9 cm in parts of at most 1 cm, or half of the plate's 3 cm";
        EXPECT_FALSE(report.tunnelled);
        for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
            const Vec3 rest = m_garment.rest().vertices.row(i);
            const bool in_its_way = std::max(std::abs(rest.y()), std::abs(rest.z())) < 0.19;
            EXPECT_TRUE(!in_its_way || state.x(i, 0) > 0.0439) << "vertex " << i;
        }
    }
}

TEST_P(Through, WhereNoPartHelpsTheReportSaysHowThickItWas) {
    place(plate(-0.03, 0.029));
    const auto tunnelled = [&](double watch_motion) {
        auto solver = std::make_unique<Flying>(m_garment, Vec3(0.005, 0, 0));
        solver->parts_fail = true;
        GuardSettings settings;
        settings.watch_motion = watch_motion;
        ClothState state = m_state;
        return ClothStepper(m_garment, std::move(solver), settings)
            .step(m_boundary, dt, state)
            .tunnelled;
    };
    ASSERT_TRUE(tunnelled(0.02));
    EXPECT_NEAR(*tunnelled(0.02), 0.03, 1e-5);
    EXPECT_FALSE(tunnelled(0.07)) << "too slow to be searched";
    place(plate(-0.09, -0.03));
    EXPECT_FALSE(tunnelled(0.02)) << "stays on its side";
}

TEST_P(Through, WithoutSubstepsNothingIsWatched) {
    place(plate(-0.03, 0.029));
    GuardSettings settings;
    settings.max_substeps = 1;
    ClothStepper stepper(m_garment, std::make_unique<Flying>(m_garment, Vec3(0.005, 0, 0)),
                         settings);
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    EXPECT_FALSE(report.tunnelled);
    EXPECT_EQ(report.substeps, 1);
}

/// A bar thinner than vertices are apart, which moves as the plate does and passes one of them.
class ThroughFew : public Through {
 protected:
    ThroughFew() {
        for (Eigen::Index i = 0; i < m_state.x.rows(); ++i)
            if (m_state.x.row(i).norm() < m_state.x.row(m_vertex).norm()) m_vertex = i;
        m_bar = at_vertex(plate(-0.03, 0.029), 0.015);
        place(m_bar);
    }
    Obstacle at_vertex(Obstacle box, double half_length) const {
        box.half_extents = Vec3(half_length, 0.012, 0.012);
        for (Pose* pose : {&box.pose0, &box.pose1}) {
            pose->translation().y() = m_state.x(m_vertex, 1);
            pose->translation().z() = m_state.x(m_vertex, 2);
        }
        return box;
    }
    StepReport fly() {
        ClothStepper stepper(m_garment, std::make_unique<Flying>(m_garment, m_way));
        return stepper.step(m_boundary, dt, m_state);
    }
    Eigen::Index m_vertex = 0;
    Obstacle m_bar;
    const Vec3 m_way = Vec3(0.005, 0, 0);
    const ClothState m_before = m_state;
};

TEST_P(ThroughFew, PointsAreMovedBackToWhereTheyWentIn) {
    TunnellingDetector detector(m_garment);
    const Points through = m_state.x.rowwise() + m_way.transpose();
    const auto found = static_cast<int>(detector.find(m_boundary, m_state.x, through, 0).size());
    ASSERT_GT(found, 0);
    ASSERT_LE(found, m_garment.vertex_count() / 100) << "not few";
    const StepReport report = fly();
    EXPECT_EQ(report.substeps, 1);
    EXPECT_EQ(report.iterations, 0) << "nothing was solved again";
    EXPECT_FALSE(report.tunnelled);
    EXPECT_EQ(report.points_tunnelled, 0);
    EXPECT_TRUE(detector.find(m_boundary, m_before.x, m_state.x, 0).empty());
    EXPECT_NEAR(m_state.x(m_vertex, 0), 0.029 + 0.015 + StepSettings().safety_distance, 1e-9);
    for (Eigen::Index i = 0; i < m_state.x.rows(); ++i) {
        const Vec3 step = m_state.x.row(i) - m_before.x.row(i);
        if ((step - m_way).norm() > 1e-12) {
            EXPECT_LT((m_state.v.row(i).transpose() - step / dt).norm(), 1e-9);
            EXPECT_LT((m_before.x.row(i) - m_before.x.row(m_vertex)).norm(), 0.06);
        }
    }
}

TEST_P(ThroughFew, PointsWithoutRoomWhereTheyWentInStayAndAreReported) {
    const Obstacle wall = at_vertex(plate(0.15, 0.07), 0.05);  // comes to lie over the bar's front
    m_boundary.obstacles.push_back(GetParam() ? as_mesh(wall) : wall);
    const Points flown = m_state.x.rowwise() + m_way.transpose();
    const StepReport report = fly();
    EXPECT_EQ(report.substeps, 1);
    ASSERT_TRUE(report.tunnelled);
    EXPECT_NEAR(*report.tunnelled, 0.03, 1e-5);
    EXPECT_GT(report.points_tunnelled, 0);
    EXPECT_EQ(m_state.x, flown);
}

TEST_P(ThroughFew, PointsStayWhereGoalsDoNotLetThemBack) {
    const Points flown = m_state.x.rowwise() + m_way.transpose();
    m_boundary.goals = SkinGoals::at(flown);
    for (const double distance : {0.02, 0.05}) {  // they would go back by 4 cm
        GoalLimits limits;
        limits.max_distance.setConstant(m_garment.vertex_count(), distance);
        const Garment held = m_garment.with_goals(limits);
        ClothStepper stepper(held, std::make_unique<Flying>(held, m_way));
        ClothState state = m_before;
        const StepReport report = stepper.step(m_boundary, dt, state);
        EXPECT_EQ(report.substeps, 1);
        EXPECT_EQ(report.tunnelled.has_value(), distance < 0.04);
        EXPECT_EQ(report.points_tunnelled > 0, distance < 0.04);
        EXPECT_EQ(state.x == flown, distance < 0.04);
    }
}

TEST_P(ThroughFew, PointsStayWhereGoingBackWouldTearTheCloth) {
    const Points flown = m_state.x.rowwise() + m_way.transpose();
    for (const double stretch : {1.0, 1.9}) {
        TriMesh rest = m_garment.rest();
        rest.vertices /= stretch;
        const Garment garment("stretched", std::move(rest), m_garment.fabric());
        ClothStepper stepper(garment, std::make_unique<Flying>(garment, m_way));
        ClothState state = m_before;
        const StepReport report = stepper.step(m_boundary, dt, state);
        EXPECT_EQ(report.substeps, 1);
        EXPECT_EQ(report.tunnelled.has_value(), stretch > 1.0);
        EXPECT_EQ(report.points_tunnelled > 0, stretch > 1.0);
        EXPECT_EQ(state.x == flown, stretch > 1.0);
    }
}

/// Flies on where it should be held.
class FlyingOn : public Flying {
 public:
    using Flying::Flying;
    StepReport correct(const Boundary& boundary, double h, const TunnellingDetector*,
                       const IterationLimits&, ClothState& state) override {
        return whole(boundary, h, state);
    }
};

/// Edges would be stretched from 1.6 to twice their length.
TEST_P(ThroughFew, NeighboursFollowWhatACorrectionDoesNotHold) {
    TriMesh rest = m_garment.rest();
    rest.vertices /= 1.6;
    const Garment garment("stretched", std::move(rest), m_garment.fabric());
    m_bar.half_extents = Vec3(0.015, 0.006, 0.006);  // no more than the vertex is in its way
    place(m_bar);
    const auto stretch_after = [&](std::unique_ptr<StepSolver> solver, bool held) {
        ClothState state = m_before;
        const StepReport report =
            ClothStepper(garment, std::move(solver)).step(m_boundary, dt, state);
        EXPECT_EQ(report.tunnelled.has_value(), !held);
        EXPECT_EQ(report.substeps, 1);
        double stretch = 0.0;
        const Points& at_rest = garment.rest().vertices;
        for (const auto& [a, b] : garment.edges())
            stretch = std::max(stretch, (state.x.row(a) - state.x.row(b)).norm() /
                                            (at_rest.row(a) - at_rest.row(b)).norm());
        return stretch;
    };
    auto alone = std::make_unique<Flying>(garment, m_way);
    alone->corrections_fail = true;
    EXPECT_LT(stretch_after(std::move(alone), false), 1.6 + 1e-9) << "nothing was moved back";
    EXPECT_LT(stretch_after(std::make_unique<FlyingOn>(garment, m_way), true), 1.61);
}

INSTANTIATE_TEST_SUITE_P(PrimitiveAndMesh, ThroughFew, ::testing::Bool(),
                         [](const auto& scene) { return scene.param ? "mesh" : "box"; });
INSTANTIATE_TEST_SUITE_P(PrimitiveAndMesh, Through, ::testing::Bool(),
                         [](const auto& scene) { return scene.param ? "mesh" : "box"; });

/// A handkerchief that hangs before a ball does not see the plate that comes through the ball.
class Unforeseen : public Through {
 protected:
    Unforeseen() {
        place(plate(0.06, -0.03));
        m_boundary.obstacles.push_back(ball(0.41, 0.41));
        m_boundary.obstacles.back().radius = 0.4;
    }
    static TriMesh handkerchief() {
        TriMesh mesh = upright();
        mesh.vertices *= 0.2;
        return mesh;
    }
    const Garment garment{"handkerchief", handkerchief(), Fabric::soft_cotton(), {}};
    ClothState start = ClothState::at_rest(garment);
};

TEST_P(Unforeseen, ASolidIsHeldWithoutParts) {
    TunnellingDetector detector(garment);
    const auto passed = [&](ClothStepper& stepper, StepReport& report) {
        ClothState state = start;
        report = stepper.step(m_boundary, dt, state);
        return detector.find(m_boundary, start.x, state.x, 0).size();
    };
    StepReport report;
    ClothStepper inner(garment, ClothStepperSettings::plain(GuardSettings().iterations));
    ASSERT_GT(passed(inner, report), 500u) << "the scene is none";
    ClothStepper stepper(garment);
    EXPECT_EQ(passed(stepper, report), 0u);
    EXPECT_EQ(report.substeps, 1);
    EXPECT_FALSE(report.tunnelled);
    EXPECT_LT(report.max_penetration, 1e-3);
}

TEST_P(Unforeseen, ToHoldItTakesNoMoreIterationsThanTheSmallStepsDid) {
    start.v.col(2).setConstant(0.3);  // at rest it would be one step
    ClothStepper stepper(garment);
    const int before = 4 * 3;
    const StepReport report = stepper.step(m_boundary, dt, start);
    EXPECT_FALSE(report.tunnelled);
    EXPECT_EQ(report.substeps, 1);
    EXPECT_GT(report.iterations, before) << "nothing was corrected";
    EXPECT_LE(report.iterations, 2 * before);
}

INSTANTIATE_TEST_SUITE_P(PrimitiveAndMesh, Unforeseen, ::testing::Bool(),
                         [](const auto& scene) { return scene.param ? "mesh" : "box"; });

TEST_F(Guard, WhenTheFinerStepFailsTheFirstOneCounts) {
    m_boundary.obstacles = {ball(-0.2, -0.13)};
    const Points moved = m_state.x.array() + 1.0;
    auto solver = std::make_unique<Entering>(m_garment, 0.02);
    solver->parts_fail = true;
    ClothStepper stepper(m_garment, std::move(solver), entries_of_a_centimetre());
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 1);
    EXPECT_EQ(m_state.x, moved);
}

TEST_F(Guard, SteppersSayHowDeepTheyWentPastASurface) {
    m_boundary.obstacles = {ball(-0.3, -0.05)};  // at t it is out of reach
    const StepReport report = ClothStepper(m_garment, plain()).step(m_boundary, dt, m_state);
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
    m_boundary.obstacles = {two_skins(0.3)};  // the first is the sheet's own limb
    auto solver = std::make_unique<Entering>(m_garment, 0.0);
    const Entering& seen = *solver;
    ClothStepper stepper(m_garment, std::move(solver));
    stepper.step(m_boundary, dt, m_state);
    ASSERT_EQ(seen.ignored.size(), size_t(m_garment.vertex_count()));
    EXPECT_EQ(seen.ignored, stepper.ignored_limbs());
    EXPECT_EQ(std::count(seen.ignored.begin(), seen.ignored.end(), LimbSet(2)),
              std::count_if(seen.ignored.begin(), seen.ignored.end(),
                            [](LimbSet set) { return set != 0; }));
    EXPECT_GT(std::count(seen.ignored.begin(), seen.ignored.end(), LimbSet(2)), 50);
}

TEST_F(Guard, TellsHowDeepTheGarmentIsInLimbsThatItIgnores) {
    m_boundary.obstacles = {two_skins(1.2)};
    GuardSettings guard;
    guard.max_substeps = 1;
    const auto shifted = [&](double shift) {
        ClothState state = m_state;
        return ClothStepper(m_garment, std::make_unique<Flying>(m_garment, Vec3(shift, 0, 0)),
                            guard)
            .step(m_boundary, dt, state);
    };
    const StepReport deep = shifted(-0.06);
    EXPECT_EQ(deep.vertices_in_ignored_limbs, m_garment.vertex_count());
    EXPECT_NEAR(deep.max_ignored_depth, 0.02, 1e-9);
    EXPECT_EQ(shifted(-0.03).vertices_in_ignored_limbs, 0);
}

TEST_F(Guard, TheTimeThatLimbsTakeIsThatOfProximity) {
    m_boundary.obstacles = {two_skins(1.2)};
    const auto proximity_ms = [&](GuardSettings guard) {
        guard.max_substeps = 1;
        ClothStepper stepper(m_garment, std::make_unique<Flying>(m_garment, Vec3::Zero()), guard);
        return stepper.step(m_boundary, dt, m_state).times.proximity;
    };
    EXPECT_GT(proximity_ms({}), 0.0);
    EXPECT_EQ(proximity_ms(GuardSettings::off()), 0.0) << "the solver takes none";
}

TEST_F(Guard, AnImpossibleStepStillFailsAndChangesNothing) {
    ClothStepper stepper(m_garment, guarded());
    const ClothState before = m_state;
    EXPECT_FALSE(stepper.step(m_boundary, -1.0, m_state).finite);
    m_boundary.gravity.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(stepper.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.v, before.v);
}

/// Parts that do nothing but spoil the boundary of the whole step, where the first part has begun.
class Spoiling : public StepSolver {
 public:
    Spoiling(const Garment& garment, Boundary& boundary)
        : StepSolver(garment, StepSettings::whole()), m_boundary(&boundary) {}
    StepReport part(const Boundary&, double h, const IterationLimits&, ClothState& state) override {
        m_boundary->obstacles[0].friction = std::numeric_limits<double>::quiet_NaN();
        ++parts;
        state.time += h;
        return {};
    }
    int parts = 0;

 private:
    Boundary* m_boundary;
};

TEST_F(Guard, TheBoundaryIsValidatedOnceForAStepAndItsParts) {
    m_boundary.obstacles = {ball(-0.3, 1.4)};
    auto solver = std::make_unique<Spoiling>(m_garment, m_boundary);
    const Spoiling& seen = *solver;
    ClothStepper stepper(m_garment, std::move(solver));
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    EXPECT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 16);
    EXPECT_EQ(seen.parts, 16) << "a part that looks at the boundary again refuses it";
    EXPECT_FALSE(stepper.step(m_boundary, dt, m_state).finite) << "as the next step does";
    EXPECT_EQ(seen.parts, 16);
}

TEST_F(Guard, NothingIsFactorisedInAFrameThatWasPreparedFor) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::bdf2}) {
        ClothStepperSettings settings = guarded();
        settings.step.potential.integrator = integrator;
        ClothStepper stepper(m_garment, settings);
        stepper.prepare(dt);
        const int before = stepper.solver().factorisations();
        EXPECT_EQ(before, integrator == Integrator::bdf2 ? 10 : 5) << "1, 2, 4, 8 and 16 parts";
        ClothState state = m_state;
        for (const double end : {-0.12, 0.1, 0.12, 1.7}) {
            m_boundary.obstacles = {ball(-0.3, end)};
            ASSERT_TRUE(stepper.step(m_boundary, dt, state).finite);
        }
        EXPECT_EQ(stepper.solver().factorisations(), before);
    }
}

TEST_F(Guard, OneHierarchyOfAnObstacleServesAStepAndItsParts) {
    ClothStepper stepper(m_garment, guarded());
    int parts = 0;
    for (const double end : {-0.01, 0.13, 0.16}) {
        m_boundary.obstacles = {as_mesh(plate(end - 0.14, end))};
        static const auto faces = m_boundary.obstacles[0].faces;
        m_boundary.obstacles[0].faces = faces;
        const StepReport report = stepper.step(m_boundary, dt, m_state);
        ASSERT_TRUE(report.finite);
        parts += report.substeps;
    }
    ASSERT_GT(parts, 3) << "the scene asks for no parts";
    const ObstacleTrees::Counts counts = stepper.trees().counts();
    EXPECT_EQ(counts.builds, 2) << "one for its surface, one for its motion";
    EXPECT_LE(counts.surface_fits, parts + 3) << "the end of a part is the start of the next";
    EXPECT_LE(counts.motion_fits, parts);
}

TEST_F(Guard, PartsTakeOverWhatTheWorldHasBuilt) {
    ClothStepper stepper(m_garment, guarded());
    m_boundary.trees = std::make_shared<ObstacleTrees>();
    m_boundary.obstacles = {as_mesh(plate(-0.03, 0.13))};
    EXPECT_GT(stepper.step(m_boundary, dt, m_state).substeps, 1);
    EXPECT_EQ(m_boundary.trees->counts().builds, 2);
    EXPECT_EQ(stepper.trees().counts().builds, 0);
    EXPECT_GT(stepper.trees().counts().surface_fits, 1);
}

TEST(MostResidual, IsReachedUntilItIsTakenBack) {
    Garment garment("sheet", make_sheet(0.4, 0.4, 150), Fabric::soft_cotton());
    garment = garment.with_pins({0});
    for (const IterationLimits& limits :
         {IterationLimits::controlled(), IterationLimits::exactly(3)}) {
        const auto step = [&](ClothStepper& stepper, int* iterations = nullptr) {
            Boundary boundary;
            ClothState state = ClothState::at_rest(garment);
            boundary.pin_targets = state.x.topRows(1);
            boundary.pin_targets(0, 1) += 0.01;
            const StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
            EXPECT_TRUE(report.finite);
            if (iterations) *iterations = report.iterations;
            return std::pair(report.residual.value(), state.x);
        };
        ClothStepper stepper(garment, ClothStepperSettings::plain(limits));
        const auto [usual, x] = step(stepper);
        EXPECT_GT(usual, 1e-3);
        int iterations = 0;
        EXPECT_TRUE(stepper.set_most_residual(1e-3));
        EXPECT_LE(step(stepper, &iterations).first, 1e-3);
        EXPECT_LE(iterations, 200);
        stepper.set_max_iterations(5);
        step(stepper, &iterations);
        EXPECT_LE(iterations, 5) << "what the user limits, stays limited";
        stepper.set_max_iterations(std::numeric_limits<int>::max());
        stepper.set_most_residual(std::numeric_limits<double>::infinity());
        EXPECT_EQ(step(stepper).second, x);
    }
    EXPECT_FALSE(ClothStepper(garment, ClothStepperSettings::reference()).set_most_residual(1e-2));
    IterationLimits bad;
    bad.most_residual = -1.0;
    EXPECT_THROW(ClothStepper(garment, ClothStepperSettings::plain(bad)), ArgumentError);
}

TEST_F(Guard, WithoutASolverItIsRefused) {
    EXPECT_THROW(ClothStepper(m_garment, std::unique_ptr<StepSolver>()), ArgumentError);
}

class Parts : public ::testing::Test {
 protected:
    static ClothStepper cut(const Garment& garment, int substeps, int iterations = 20) {
        ClothStepperSettings settings =
            ClothStepperSettings::plain(IterationLimits::exactly(iterations));
        settings.substeps = substeps;
        return ClothStepper(garment, settings);
    }
    const Garment m_garment{"sheet", make_sheet(0.3, 0.3, 80), Fabric::soft_cotton(), {0, 3}};
    ClothState m_state = ClothState::at_rest(m_garment);
    Boundary m_boundary = [this] {
        Boundary boundary;
        boundary.pin_targets.resize(2, 3);
        boundary.pin_targets.row(0) = m_state.x.row(0) + Vec3(0.03, 0, 0).transpose();
        boundary.pin_targets.row(1) = m_state.x.row(3) + Vec3(0, 0.06, 0).transpose();
        return boundary;
    }();
};

TEST_F(Parts, AreEqualSmallStepsByHand) {
    ClothStepper stepper = cut(m_garment, 4), inner = cut(m_garment, 1);
    ClothState by_hand = m_state;
    const Points from = m_state.x;
    ASSERT_TRUE(stepper.step(m_boundary, dt, m_state).finite);
    for (int k = 1; k <= 4; ++k) {
        Boundary part = m_boundary;
        if (k < 4)
            for (int p = 0; p < 2; ++p)
                part.pin_targets.row(p) = (1 - k / 4.0) * from.row(m_garment.pins()[p]) +
                                          k / 4.0 * m_boundary.pin_targets.row(p);
        ASSERT_TRUE(inner.step(part, dt / 4, by_hand).finite);
    }
    EXPECT_EQ(m_state.x, by_hand.x);
    EXPECT_LT((m_state.v - (m_state.x - from) / dt).cwiseAbs().maxCoeff(), 1e-12);
    // and go on from the last part's velocity
    ASSERT_TRUE(stepper.step(m_boundary, dt, m_state).finite);
    for (int k = 1; k <= 4; ++k) ASSERT_TRUE(inner.step(m_boundary, dt / 4, by_hand).finite);
    EXPECT_LT((m_state.x - by_hand.x).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_DOUBLE_EQ(m_state.time, 2 * dt);
    EXPECT_EQ(m_state.x.row(3), m_boundary.pin_targets.row(1));
}

TEST_F(Parts, FallNearerToTheParabola) {
    const Garment free("sheet", m_garment.rest(), Fabric::soft_cotton());
    m_boundary.pin_targets.resize(0, 3);
    double error[2];
    for (const int substeps : {1, 8}) {
        ClothState state = ClothState::at_rest(free);
        ClothStepper stepper = cut(free, substeps);
        for (int frame = 0; frame < 15; ++frame) stepper.step(m_boundary, dt, state);
        const double fallen = state.x(7, 1) - free.rest().vertices(7, 1);
        error[substeps == 8] = std::abs(fallen + 0.5 * 9.81 * 0.25);
    }
    // Backward Euler falls too far by g t h / 2.
    EXPECT_NEAR(error[0], 0.5 * 9.81 * 0.5 * dt, 1e-6);
    EXPECT_NEAR(error[1], error[0] / 8, 1e-6);
}

/// Parts that fail from one on.
class FailingAt : public StepSolver {
 public:
    FailingAt(const Garment& garment, int good)
        : StepSolver(garment, StepSettings::whole()), m_good(good) {}
    StepReport part(const Boundary&, double h, const IterationLimits&, ClothState& state) override {
        if (m_good-- == 0) return StepReport::failed();
        state.x.array() += h;
        StepReport report;
        report.iterations = 2;
        report.times.solve = 1.0;
        return report;
    }

 private:
    int m_good;
};

TEST_F(Parts, AreAddedUpInTheReport) {
    ClothStepper stepper(m_garment, std::make_unique<FailingAt>(m_garment, 3), GuardSettings::off(),
                         3);
    const StepReport report = stepper.step(m_boundary, dt, m_state);
    ASSERT_TRUE(report.finite);
    EXPECT_EQ(report.substeps, 3);
    EXPECT_EQ(report.iterations, 6);
    EXPECT_DOUBLE_EQ(report.times.solve, 3.0);
}

TEST_F(Parts, AFailureInTheMiddleLeavesTheStateAsItWas) {
    ClothStepper stepper(m_garment, std::make_unique<FailingAt>(m_garment, 1), GuardSettings::off(),
                         3);
    const ClothState before = m_state;
    EXPECT_FALSE(stepper.step(m_boundary, dt, m_state).finite);
    EXPECT_EQ(m_state.x, before.x);
    EXPECT_EQ(m_state.time, before.time);
}

TEST_F(Parts, AreNamed) {
    EXPECT_EQ(cut(m_garment, 4, 3).name(), "quasi-newton-3x4");
    EXPECT_EQ(cut(m_garment, 1, 3).name(), "quasi-newton-3");
    EXPECT_EQ(ClothStepper(m_garment).name(), "quasi-newton-3s120");
    EXPECT_EQ(ClothStepper(m_garment, ClothStepperSettings::reference()).name(), "reference");
}

}  // namespace
}  // namespace cloth::cloth_stepper_test
