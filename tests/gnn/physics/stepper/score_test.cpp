#include "gnn/physics/stepper/score.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::score_test {
namespace {

using test::sheet_on_sphere;
using test::SolverScene;
using test::swinging_sheet;

constexpr double dt = 1.0 / 30.0;

StepReference reference_of(const SolverScene& scene) {
    return StepReference(scene.garment, {}, scene.state, scene.boundary, dt,
                         patient_quasi_newton(scene.garment));
}

TEST(StepReference, ScoresTheLandmarksOfAStep) {
    const SolverScene scene = swinging_sheet(10);
    const StepReference reference = reference_of(scene);
    EXPECT_TRUE(reference.report().converged);

    const StepScore best = reference.score(reference.minimum());
    EXPECT_EQ(best.gap, 0.0);
    EXPECT_EQ(best.progress, 0.0);
    EXPECT_EQ(best.rmse_mm, 0.0);

    EXPECT_NEAR(reference.score(reference.guess()).gap, 1.0, 1e-12);
    Points still = scene.state.x;
    place_pins(scene.garment, scene.boundary, still);
    EXPECT_NEAR(reference.score(still).progress, 1.0, 1e-12);
}

TEST(StepReference, OrdersSolversByTheirIterations) {
    for (const SolverScene& scene : {swinging_sheet(10), sheet_on_sphere(10)}) {
        const StepReference reference = reference_of(scene);
        double last_gap = 1.0;
        for (const int iterations : {1, 3, 10, 30}) {
            QuasiNewtonSettings settings;
            settings.iterations = iterations;
            Points x = reference.guess();
            QuasiNewton(scene.garment, settings).minimise(reference.potential(), x);
            const StepScore score = reference.score(x);
            EXPECT_LT(score.gap, last_gap) << iterations << " iterations";
            EXPECT_GE(score.gap, 0.0);
            last_gap = score.gap;
        }
        EXPECT_LT(last_gap, 0.02);
    }
}

TEST(StepReference, MeasuresDistanceInMillimetres) {
    const SolverScene scene = swinging_sheet(8);
    const StepReference reference = reference_of(scene);
    Points x = reference.minimum();
    x.rowwise() += Eigen::RowVector3d(3e-3, 0.0, 4e-3);
    EXPECT_NEAR(reference.score(x).rmse_mm, 5.0, 1e-9);
}

TEST(StepReference, SplitsTheEnergyIntoItsTerms) {
    const SolverScene scene = swinging_sheet(8);
    const StepReference reference = reference_of(scene);
    const StepScore score = reference.score(reference.guess());
    EXPECT_DOUBLE_EQ(score.energy, score.terms.total());
    EXPECT_DOUBLE_EQ(score.energy, reference.guess_energy());
    // The guess keeps the last velocity; only its pins are away from the inertial target.
    EXPECT_GT(score.terms.strain, 0.0);
    EXPECT_EQ(score.terms.contact, 0.0);
}

TEST(StepReference, KeepsTheLowerOfTwoMinima) {
    const SolverScene scene = swinging_sheet(8);
    const Minimiser lazy = [&](const IncrementalPotential& potential, Points& x) {
        QuasiNewtonSettings settings;
        settings.iterations = 1;
        return QuasiNewton(scene.garment, settings).minimise(potential, x);
    };
    StepReference reference(scene.garment, {}, scene.state, scene.boundary, dt, lazy);
    const double lazy_energy = reference.minimum_energy();
    EXPECT_TRUE(reference.try_from(reference.guess(), patient_quasi_newton(scene.garment)));
    const double patient_energy = reference.minimum_energy();
    EXPECT_LT(patient_energy, lazy_energy);
    EXPECT_FALSE(reference.try_from(reference.guess(), lazy));
    EXPECT_EQ(reference.minimum_energy(), patient_energy);
}

TEST(StepReference, NewtonAndPatientQuasiNewtonFindTheSameMinimum) {
    const SolverScene scene = swinging_sheet(8);
    NewtonSettings settings;
    settings.tolerance = 1e-7;
    const StepReference newton(scene.garment, {}, scene.state, scene.boundary, dt,
                               newton_minimiser(scene.garment, settings));
    const StepScore score = newton.score(reference_of(scene).minimum());
    EXPECT_NEAR(score.gap, 0.0, 1e-8);
    EXPECT_LE(score.rmse_mm, 1e-3);
}

TEST(StepReference, IsRefusedForAStateThatIsNotFinite) {
    SolverScene scene = swinging_sheet(6);
    scene.state.v(3, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(reference_of(scene), ArgumentError);
}

}  // namespace
}  // namespace cloth::score_test
