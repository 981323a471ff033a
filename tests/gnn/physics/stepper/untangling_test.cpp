// Cloth that has passed through itself or through other cloth, and what untangling promises.

#include "gnn/physics/stepper/untangling.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/proximity/metrics.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/gnn/physics/stepper/tangled_scenes.h"
#include "tests/test_meshes.h"

namespace cloth::untangling_test {
namespace {

using namespace test;

constexpr double dt = 1.0 / 30.0;

SelfContactSettings contact(bool untangles = true, int threads = 0) {
    SelfContactSettings settings;
    settings.thickness = 4e-3;
    settings.threads = threads;
    if (!untangles) settings.untangling_moves = 0;
    return settings;
}

ClothStepperSettings solver(const SelfContactSettings& contact) {
    ClothStepperSettings settings = ClothStepperSettings::plain();
    settings.step.potential.self_contact = contact;
    return settings;
}

/// Frames until the scene is untangled for good; `frames`: it is not.
int frames_to_untangle(const LayerScene& scene, Stepper& stepper, int frames, ClothState& state) {
    SelfTangles tangles(scene.garment);
    state = scene.start;
    EXPECT_GT(tangles.find(state.x).size(), 15u) << "the scene asks for nothing";
    int needed = 0;
    for (int frame = 0; frame < frames; ++frame) {
        const StepReport report = stepper.step(scene.boundary, dt, state);
        EXPECT_TRUE(report.finite);
        EXPECT_EQ(report.tangles, static_cast<int>(tangles.find(state.x).size()));
        if (report.tangles > 0) needed = frame + 1;
    }
    return needed;
}

int frames_to_untangle(const LayerScene& scene, int frames) {
    ClothState state;
    ClothStepper without(scene.garment, solver(contact(false)));
    EXPECT_EQ(frames_to_untangle(scene, without, 15, state), 15) << "it would by itself";
    ClothStepper with(scene.garment, solver(contact()));
    const int needed = frames_to_untangle(scene, with, frames, state);
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.1);
    return needed;
}

double kinetic_energy(const Garment& garment, const Points& v) {
    return 0.5 * garment.masses().dot(v.rowwise().squaredNorm());
}

Vec3 weighted_sum(const Garment& garment, const Points& rows) {
    return rows.transpose() * garment.masses();
}

/// All that untangling is about, of a scene in free space.
class Bench {
 public:
    explicit Bench(const LayerScene& scene)
        : m_scene(scene),
          m_elastic(scene.garment),
          m_goals(scene.garment),
          m_measure(scene.garment),
          m_untangling(scene.garment, contact()) {}

    UntanglingReport run(ClothState& state) {
        return m_untangling.run({m_scene.boundary, m_proximity, m_goals, 5e-4, m_contacts}, dt,
                                state);
    }
    double fabric(const Points& x) const {
        const ElasticEnergy::Terms terms = m_elastic.value(x);
        return terms.strain + terms.bending;
    }
    double size(const Points& x) { return m_measure.find(x, 1); }

 private:
    const LayerScene& m_scene;
    ElasticEnergy m_elastic;
    Proximity m_proximity;
    GoalProjection m_goals;
    SurfaceContacts m_contacts;
    TangleMeasure m_measure;
    Untangling m_untangling;
};

/// A scene of layers with every vertex of the hems pinned: there is no way out.
LayerScene pinned_through() {
    LayerScene scene = tangled_sheets(150);
    const std::vector<int> piece = garment_pieces(scene.garment);
    const Points& rest = scene.garment.rest().vertices;
    std::vector<int> pins;
    for (Eigen::Index i = 0; i < rest.rows(); ++i)
        if (rest.row(i).cwiseAbs().maxCoeff() > (piece[static_cast<size_t>(i)] == 0 ? 0.145 : 0.12))
            pins.push_back(static_cast<int>(i));
    scene.garment = scene.garment.with_pins(pins);
    scene.boundary = outside({});
    scene.boundary.pin_targets.resize(static_cast<Eigen::Index>(pins.size()), 3);
    for (size_t k = 0; k < pins.size(); ++k)
        scene.boundary.pin_targets.row(static_cast<Eigen::Index>(k)) = scene.start.x.row(pins[k]);
    return scene;
}

/// RMS motion per frame (m) over the last third of the frames.
double restlessness(const LayerScene& scene, const SelfContactSettings& contact, int frames,
                    ClothState& state) {
    ClothStepper stepper(scene.garment, solver(contact));
    state = scene.start;
    double squares = 0.0;
    for (int frame = 0; frame < frames; ++frame) {
        const Points before = state.x;
        EXPECT_TRUE(stepper.step(scene.boundary, dt, state).finite);
        if (frame >= frames - frames / 3) squares += (state.x - before).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(frames / 3 * state.x.rows()));
}

}  // namespace

TEST(Untangling, ASheetFoldedThroughItselfComesApart) {
    EXPECT_LE(frames_to_untangle(corner_through_itself(), 30), 10);
}

TEST(Untangling, SheetsThroughEachOtherComeApart) {
    EXPECT_LE(frames_to_untangle(corner_through_sheet(), 30), 10) << "a corner";
    EXPECT_LE(frames_to_untangle(bump_through_sheet(), 30), 10) << "a bump";
    LayerScene crossed = tangled_sheets();
    EXPECT_LE(frames_to_untangle(crossed, 30), 10) << "halves, onto a floor";
    crossed.boundary = outside({});
    crossed.boundary.gravity.setZero();
    EXPECT_LE(frames_to_untangle(crossed, 30), 10) << "halves";
}

TEST(Untangling, SubstepsOfSpringsComeApartToo) {
    const LayerScene scene = corner_through_sheet();
    XpbdSettings settings;
    settings.self_contact = contact();
    XpbdStepper stepper(scene.garment, settings);
    ClothState state;
    EXPECT_LE(frames_to_untangle(scene, stepper, 30, state), 15);
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.2);
}

TEST(Untangling, FoldsByChanceLoseTheirTanglesAndNeverGainEnergy) {
    double before = 0.0, after = 0.0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        const LayerScene scene = folded_by_chance(seed);
        Bench bench(scene);
        ClothState state = scene.start;
        std::mt19937 random(seed);
        state.v = random_points(random, state.x.rows(), 0.1);
        before += bench.size(state.x);
        for (int step = 0; step < 20; ++step) {
            const ClothState last = state;
            const UntanglingReport report = bench.run(state);
            ASSERT_LE(report.moves, contact().untangling_moves);
            if (report.moves == 0) {
                EXPECT_TRUE(state.x == last.x && state.v == last.v);
                break;
            }
            EXPECT_LE(kinetic_energy(scene.garment, state.v),
                      kinetic_energy(scene.garment, last.v));
            EXPECT_LT((weighted_sum(scene.garment, state.v - last.v)).norm(), 1e-15);
            EXPECT_LT((weighted_sum(scene.garment, state.x - last.x)).norm(), 1e-15);
            EXPECT_LE((state.x - last.x).rowwise().norm().maxCoeff(),
                      contact().untangling_moves * 0.5 * contact().thickness * (1 + 1e-9));
            EXPECT_DOUBLE_EQ(report.before, bench.size(last.x));
            EXPECT_DOUBLE_EQ(report.after, bench.size(state.x));
        }
        after += bench.size(state.x);
    }
    EXPECT_LT(after, 0.2 * before);
}

TEST(Untangling, TheFabricGainsNoMoreThanTheTanglesLose) {
    for (const LayerScene& scene :
         {corner_through_itself(), corner_through_sheet(), bump_through_sheet()}) {
        Bench bench(scene);
        ClothState state = scene.start;
        double energy = bench.fabric(state.x) + contact().untangling_tension * bench.size(state.x);
        const double start = energy;
        for (int step = 0; step < 5; ++step) {
            bench.run(state);
            const double next =
                bench.fabric(state.x) + contact().untangling_tension * bench.size(state.x);
            EXPECT_LE(next, energy);
            energy = next;
        }
        EXPECT_LT(energy, 0.5 * start);
    }
}

TEST(Untangling, StepsKeepMomentumAndMakeNoEnergy) {
    const LayerScene scene = corner_through_itself();
    ClothStepper stepper(scene.garment, solver(contact()));
    const Bench bench(scene);
    ClothState state = scene.start;
    state.v.rowwise() += Eigen::RowVector3d(0.3, -0.2, 0.1);
    const Vec3 momentum = weighted_sum(scene.garment, state.v);
    const Vec3 mean = momentum / scene.garment.masses().sum();
    const double start = bench.fabric(state.x);
    int tangled = 0;
    for (int frame = 0; frame < 15; ++frame) {
        tangled += stepper.step(scene.boundary, dt, state).tangles > 0;
        EXPECT_LT((weighted_sum(scene.garment, state.v) - momentum).norm(), 1e-3 * momentum.norm());
        const Points own = state.v.rowwise() - mean.transpose();
        EXPECT_LT(kinetic_energy(scene.garment, own) + bench.fabric(state.x), start);
    }
    EXPECT_GT(tangled, 0);
}

TEST(Untangling, WhatIsNotTangledKeepsItsBits) {
    const LayerScene scene = folded_sheet(200);
    ClothStepper with(scene.garment, solver(contact())),
        without(scene.garment, solver(contact(false)));
    ClothState a = scene.start, b = scene.start;
    for (int frame = 0; frame < 15; ++frame) {
        with.step(scene.boundary, dt, a);
        without.step(scene.boundary, dt, b);
        ASSERT_TRUE(a.x == b.x && a.v == b.v) << frame;
    }
}

TEST(Untangling, SameBitsForAnyNumberOfThreadsAndWithoutMemory) {
    const LayerScene scene = bump_through_sheet();
    ClothStepper one(scene.garment, solver(contact(true, 1))),
        three(scene.garment, solver(contact(true, 3)));
    ClothState a = scene.start, b = scene.start;
    for (int frame = 0; frame < 4; ++frame) {
        one.step(scene.boundary, dt, a);
        three.step(scene.boundary, dt, b);
        ASSERT_TRUE(a.x == b.x && a.v == b.v) << frame;
    }
    Bench bench(scene);
    ClothState c = scene.start, d = scene.start;
    bench.run(c);
    bench.run(d);
    EXPECT_TRUE(c.x == d.x);
}

TEST(Untangling, WhatCannotBeUndoneIsQuietAndStretchesLittle) {
    const LayerScene scene = pinned_through();
    ClothState state;
    const double without = restlessness(scene, contact(false), 120, state);
    SelfTangles tangles(scene.garment);
    const size_t tangled = tangles.find(state.x).size();
    for (const double tension : {0.3, 1.0}) {
        SelfContactSettings settings = contact();
        settings.untangling_tension = tension;
        EXPECT_LE(restlessness(scene, settings, 120, state), std::max(without, 5e-5)) << tension;
        EXPECT_LT(tangles.find(state.x).size(), tangled);
        EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.25);
        for (size_t k = 0; k < scene.garment.pins().size(); ++k)
            EXPECT_EQ(state.x.row(scene.garment.pins()[k]),
                      scene.boundary.pin_targets.row(static_cast<Eigen::Index>(k)));
    }
}

TEST(Untangling, PutsNothingIntoAnObstacle) {
    LayerScene scene = tangled_sheets();
    scene.start.x.col(1).array() -= scene.start.x.col(1).minCoeff() - 2e-3;
    ClothStepper stepper(scene.garment, solver(contact()));
    ClothState state = scene.start;
    int tangles = 1;
    for (int frame = 0; frame < 20; ++frame) {
        tangles = stepper.step(scene.boundary, dt, state).tangles;
        EXPECT_GE(state.x.col(1).minCoeff(), -1e-9);
    }
    EXPECT_EQ(tangles, 0);
}

TEST(Untangling, RefusesSettingsOutOfRange) {
    const LayerScene scene = corner_through_sheet(50);
    SelfContactSettings settings = contact();
    settings.untangling_tension = -1.0;
    EXPECT_THROW(Untangling(scene.garment, settings), std::invalid_argument);
    settings = contact();
    settings.untangling_moves = 101;
    EXPECT_THROW(Untangling(scene.garment, settings), std::invalid_argument);
}

}  // namespace cloth::untangling_test
