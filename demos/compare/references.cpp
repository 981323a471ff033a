#include "demos/compare/references.h"

#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth {

static constexpr int fine_rate = 240;  // steps per second

static ClothStepperSettings many_iterations(int iterations, double tolerance) {
    return ClothStepperSettings::plain(IterationLimits::until(tolerance, iterations));
}

ClothState settle(const ComparisonScene& scene, const ProgressFunction& progress) {
    ClothStepper stepper(scene.garment(), many_iterations(60, 1e-3));
    return settle(scene, stepper, progress);
}

ClothState settle(const ComparisonScene& scene, Stepper& stepper,
                  const ProgressFunction& progress) {
    ClothState state = scene.start();
    const double dt = scene.frame_time();
    const int steps = scene.lead_in_frames();
    for (int k = 0; k < steps; ++k) {
        stepper.step(scene.boundary((k - steps) * dt, (k + 1 - steps) * dt), dt, state);
        progress(k + 1, steps, "the garment settles");
    }
    state.time = 0.0;
    return state;
}

/// Goes on to so many frames, `substeps` steps each.
static Trajectory extend(const ComparisonScene& scene, Stepper& stepper, int substeps,
                         Trajectory trajectory, int frames, const std::string& what,
                         const ProgressFunction& progress) {
    const double dt = scene.frame_time() / substeps;
    for (int frame = static_cast<int>(trajectory.size()) - 1; frame < frames; ++frame) {
        ClothState state = trajectory.back();
        for (int step = frame * substeps; step < (frame + 1) * substeps; ++step)
            stepper.step(scene.boundary(step * dt, (step + 1) * dt), dt, state);
        trajectory.push_back(std::move(state));
        progress(frame + 1, frames, what);
    }
    return trajectory;
}

Trajectory coarse_reference(const ComparisonScene& scene, Trajectory begun, int frames,
                            const ProgressFunction& progress) {
    ClothStepper stepper(scene.garment(), ClothStepperSettings::reference());
    return extend(scene, stepper, 1, std::move(begun), frames,
                  "reference, 1/" + std::to_string(scene.rate()) + " s", progress);
}

Trajectory fine_reference(const ComparisonScene& scene, Trajectory begun, int frames,
                          const ProgressFunction& progress) {
    // At 1/240 s inertia rules the potential and the quasi-Newton matrix is nearly its Hessian.
    ClothStepper stepper(scene.garment(), many_iterations(100, 1e-4));
    const int substeps = fine_rate / scene.rate();
    return extend(scene, stepper, substeps, std::move(begun), frames, "reference, 1/240 s",
                  progress);
}

}  // namespace cloth
