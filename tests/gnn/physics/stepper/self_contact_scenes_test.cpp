// Cloth that meets itself, stepped by the solvers.

#include "tests/gnn/physics/stepper/self_contact_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "collision/proximity/metrics.h"
#include "collision/self/self_tangles.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/two_limbs.h"

namespace cloth::self_contact_scenes_test {
namespace {

using namespace test;

constexpr double dt = 1.0 / 30.0;

ClothStepperSettings solver(double thickness, int threads = 0) {
    ClothStepperSettings settings = ClothStepperSettings::plain();
    settings.step.potential.self_contact.thickness = thickness;
    settings.step.potential.self_contact.threads = threads;
    return settings;
}

/// Steps the scene; the most tangles that any frame ended with, as counted from outside.
size_t most_tangles(const LayerScene& scene, Stepper& stepper, int frames, ClothState& state) {
    SelfTangles tangles(scene.garment);
    size_t most = 0;
    state = scene.start;
    EXPECT_TRUE(tangles.find(state.x).empty()) << "tangled before it begins";
    for (int frame = 0; frame < frames; ++frame) {
        const StepReport report = stepper.step(scene.boundary, dt, state);
        EXPECT_TRUE(report.finite);
        EXPECT_LE(report.tangles, static_cast<int>(tangles.find(state.x).size()));
        most = std::max(most, tangles.found().size());
    }
    return most;
}

double least_distance(const Garment& garment, const Points& x) {
    SelfProximity proximity(garment, 4e-3);
    proximity.find(x, Points::Zero(x.rows(), 3), 4e-3, 1);
    double least = 4e-3;
    for (const SelfPair& pair : proximity.pairs()) least = std::min(least, pair.distance);
    return least;
}

}  // namespace

TEST(SelfContactScenes, AFoldedSheetOnTheFloorKeepsItsLayersApart) {
    const LayerScene scene = folded_sheet();
    ClothState state;
    ClothStepper without(scene.garment, solver(0.0));
    EXPECT_GT(most_tangles(scene, without, 15, state), 100u) << "the scene asks for nothing";

    ClothStepper with(scene.garment, solver(4e-3));
    EXPECT_EQ(most_tangles(scene, with, 60, state), 0u);
    EXPECT_GT(least_distance(scene.garment, state.x), 1e-3);
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.1);
    EXPECT_LT(std::sqrt(state.v.squaredNorm() / static_cast<double>(state.v.rows())), 0.1);
}

TEST(SelfContactScenes, ARibbonFallsIntoAPileWithoutATangle) {
    const LayerScene scene = falling_ribbon();
    ClothState state;
    ClothStepper without(scene.garment, solver(0.0));
    EXPECT_GT(most_tangles(scene, without, 15, state), 100u) << "the scene asks for nothing";

    ClothStepper with(scene.garment, solver(4e-3));
    EXPECT_EQ(most_tangles(scene, with, 60, state), 0u);
    EXPECT_LT(state.x.col(1).maxCoeff(), 0.3) << "it is still in the air";
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.1);
}

TEST(SelfContactScenes, ASheetThatFallsOnASheetStaysAbove) {
    const LayerScene scene = sheet_on_sheet();
    const std::vector<int> piece = garment_pieces(scene.garment);
    ClothState state;
    ClothStepper stepper(scene.garment, solver(4e-3));
    EXPECT_EQ(most_tangles(scene, stepper, 30, state), 0u);
    SelfProximity proximity(scene.garment, 4e-3);
    proximity.find(state.x, Points::Zero(state.x.rows(), 3), 6e-3, 1);
    int above = 0, below = 0;
    for (const SelfPair& pair : proximity.pairs()) {
        const int first = pair.elements.vertex[0], second = pair.elements.vertex[3];
        const int side = piece[static_cast<size_t>(first)] - piece[static_cast<size_t>(second)];
        const Vec3 out = state.x.row(first).normalized();  // the ball is at the origin
        const double height = side * pair.normal.dot(out);
        // folds at the hem stand upright: there neither layer is above the other
        above += height > 0.5;
        below += height < -0.5;
    }
    EXPECT_EQ(below, 0);
    EXPECT_GT(above, 100);
}

TEST(SelfContactScenes, WithoutUntanglingATangledStartIsReportedAndGetsNoWorse) {
    const LayerScene scene = tangled_sheets(100);
    SelfTangles tangles(scene.garment);
    const int tangled = static_cast<int>(tangles.find(scene.start.x).size());
    ASSERT_GT(tangled, 15);
    ClothStepperSettings settings = solver(4e-3);
    settings.step.potential.self_contact.untangling_moves = 0;
    ClothStepper stepper(scene.garment, settings);
    ClothState state = scene.start;
    for (int frame = 0; frame < 20; ++frame) {
        const StepReport report = stepper.step(scene.boundary, dt, state);
        ASSERT_TRUE(report.finite);
        EXPECT_EQ(report.tangles, static_cast<int>(tangles.find(state.x).size()));
        EXPECT_GT(report.tangles, 0);
        EXPECT_LE(report.tangles, tangled);
        EXPECT_EQ(report.first_tangle, tangles.found().front().point);
    }
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.3);
}

TEST(SelfContactScenes, AStateThatIsReplacedIsLookedThroughAgain) {
    const LayerScene scene = tangled_sheets(100);
    SelfTangles tangles(scene.garment);
    ClothStepper stepper(scene.garment, solver(4e-3));
    ClothState apart = ClothState::at_rest(scene.garment);
    const std::vector<int> piece = garment_pieces(scene.garment);
    for (Eigen::Index i = 0; i < apart.x.rows(); ++i) apart.x(i, 1) += piece[size_t(i)] * 0.5;
    for (int frame = 0; frame < 2; ++frame)
        EXPECT_EQ(stepper.step(scene.boundary, dt, apart).tangles, 0);
    ClothState state = scene.start;
    const StepReport report = stepper.step(scene.boundary, dt, state);
    EXPECT_GT(report.tangles, 0);
    EXPECT_EQ(report.tangles, static_cast<int>(tangles.find(state.x).size()));
}

TEST(SelfContactScenes, TheReferenceKeepsLayersApartToo) {
    const LayerScene scene = folded_sheet(120, 0.02);
    ClothStepperSettings settings = ClothStepperSettings::reference();
    settings.step.potential.self_contact.thickness = 4e-3;
    ClothStepper reference(scene.garment, settings);
    ClothState state = scene.start;
    SelfTangles tangles(scene.garment);
    int converged = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const StepReport report = reference.step(scene.boundary, dt, state);
        ASSERT_TRUE(report.finite);
        converged += report.converged;
        EXPECT_TRUE(tangles.find(state.x).empty());
    }
    EXPECT_GE(converged, 8);
}

TEST(SelfContactScenes, SubstepsOfSpringsKeepLayersApartToo) {
    const LayerScene scene = folded_sheet();
    XpbdSettings settings;
    settings.self_contact.thickness = 4e-3;
    XpbdStepper stepper(scene.garment, settings);
    ClothState state;
    EXPECT_EQ(most_tangles(scene, stepper, 30, state), 0u);
    EXPECT_LT(measure_stretch(scene.garment, state.x).p99, 1.2);
}

TEST(SelfContactScenes, ClothThatDoesNotMeetItselfMovesAsWithoutBitByBit) {
    const Garment garment("sheet", make_sheet(0.3, 0.3, 200), Fabric::soft_cotton());
    const Boundary boundary = outside({ball(0.15)});
    ClothStepper without(garment, solver(0.0)), with(garment, solver(4e-3));
    ClothState a = ClothState::at_rest(garment);
    a.x.col(1).array() += 0.16;
    ClothState b = a;
    for (int frame = 0; frame < 5; ++frame) {
        without.step(boundary, dt, a);
        with.step(boundary, dt, b);
    }
    EXPECT_TRUE(a.x == b.x);
    EXPECT_TRUE(a.v == b.v);
}

TEST(SelfContactScenes, SameBitsForAnyNumberOfThreads) {
    const LayerScene scene = falling_ribbon(200);
    ClothStepper one(scene.garment, solver(4e-3, 1)), three(scene.garment, solver(4e-3, 3));
    ClothState a = scene.start, b = scene.start;
    for (int frame = 0; frame < 20; ++frame) {
        one.step(scene.boundary, dt, a);
        three.step(scene.boundary, dt, b);
    }
    EXPECT_TRUE(a.x == b.x);
}

/// Skins that pass through each other take the cloth on them along.
TEST(SelfContactScenes, LayersOnLimbsThatOverlapStayOnTheirLimbs) {
    constexpr int frames = 24, still = 4;
    constexpr double apart = 0.25, deepest = 0.13;
    const auto place = [&](int frame) {  // there and back
        const double turn = 2.0 * M_PI * std::min(frame, frames) / frames;
        return apart + (deepest - apart) * 0.5 * (1.0 - std::cos(turn));
    };
    const auto shell = [](double radius, double x) {
        TriMesh ball = icosphere(3);
        ball.vertices = (radius * ball.vertices).rowwise() + Eigen::RowVector3d(x, 0, 0);
        return Garment("shell", ball, Fabric::soft_cotton());
    };
    const MergedGarments shells =
        merge_garments("shells", {shell(0.153, 0.0), shell(0.053, apart)});
    ClothStepperSettings settings = solver(4e-3);
    settings.guard.limbs = true;
    for (const bool joined : {false, true}) {
        const TwoLimbs body(joined);
        ClothStepper stepper(shells.garment, settings);
        ClothState state = ClothState::at_rest(shells.garment);
        double stretch = 0.0, depth = 0.0;
        int most_inside = 0;
        StepReport report;
        for (int frame = 0; frame < frames + still; ++frame) {
            Boundary boundary = body.boundary(place(frame), place(frame + 1));
            boundary.gravity.setZero();
            report = stepper.step(boundary, dt, state);
            ASSERT_TRUE(report.finite);
            most_inside = std::max(most_inside, report.vertices_in_ignored_limbs);
            stretch = std::max(stretch, measure_stretch(shells.garment, state.x).p99);
            depth = std::max(depth, report.max_penetration);
        }
        EXPECT_GT(most_inside, 300);
        EXPECT_LT(stretch,
                  joined ? 1.35 : 1.05);  // 1.19 without self-contact where they are joined
        EXPECT_LT(depth, 1e-3);
        EXPECT_EQ(report.tangles, 0);
        EXPECT_LT(measure_stretch(shells.garment, state.x).p99, 1.03);
    }
}

}  // namespace cloth::self_contact_scenes_test
