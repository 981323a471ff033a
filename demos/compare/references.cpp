#include "demos/compare/references.h"

#include "gnn/physics/implicit_stepper.h"
#include "gnn/physics/quasi_newton_stepper.h"

namespace cloth {

static QuasiNewtonSettings many_iterations(int iterations, double tolerance) {
    QuasiNewtonSettings settings;
    settings.iterations = iterations;
    settings.tolerance = tolerance;
    return settings;
}

ClothState settle(const ComparisonScene& scene, const ProgressFunction& progress) {
    QuasiNewtonStepper stepper(scene.garment(), many_iterations(60, 1e-3));
    ClothState state = ClothState::at_rest(scene.garment());
    const double dt = ComparisonScene::frame_time;
    const int steps = scene.lead_in_frames();
    for (int k = 0; k < steps; ++k) {
        stepper.step(scene.boundary((k - steps) * dt, (k + 1 - steps) * dt), dt, state);
        progress(k + 1, steps, "the garment settles");
    }
    state.time = 0.0;
    return state;
}

Trajectory coarse_reference(const ComparisonScene& scene, const ClothState& start,
                            const ProgressFunction& progress) {
    ImplicitStepper stepper(scene.garment());
    Trajectory trajectory = {start};
    for (int frame = 0; frame < scene.reference_frames(); ++frame) {
        ClothState state = trajectory.back();
        stepper.step(scene.frame_boundary(frame), ComparisonScene::frame_time, state);
        trajectory.push_back(std::move(state));
        progress(frame + 1, scene.reference_frames(), "reference, 1/30 s");
    }
    return trajectory;
}

Trajectory fine_reference(const ComparisonScene& scene, const ClothState& start,
                          const ProgressFunction& progress) {
    // At 1/240 s inertia rules the potential and the quasi-Newton matrix is nearly its Hessian.
    QuasiNewtonStepper stepper(scene.garment(), many_iterations(100, 1e-4));
    constexpr int substeps = 8;
    const double dt = ComparisonScene::frame_time / substeps;
    Trajectory trajectory = {start};
    ClothState state = start;
    for (int step = 0; step < substeps * scene.reference_frames(); ++step) {
        stepper.step(scene.boundary(step * dt, (step + 1) * dt), dt, state);
        if (step % substeps == substeps - 1) trajectory.push_back(state);
        progress(step + 1, substeps * scene.reference_frames(), "reference, 1/240 s");
    }
    return trajectory;
}

}  // namespace cloth
