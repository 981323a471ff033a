#include "demos/bullet_scenes/scene_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "demos/bullet_scenes/scene_meters.h"
#include "demos/bullet_scenes/scene_probe.h"
#include "demos/compare/statistics.h"

namespace cloth {

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double milliseconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

/// Median over the means of successive windows of 1/30 s, from step `begin` on; of random steps
/// two last longer than that.
double median_of_windows(const std::vector<double>& times, size_t begin, const StepPlan& plan) {
    const auto window = static_cast<size_t>(plan.random ? 4 : std::max(1, plan.rate / 30));
    std::vector<double> means;
    for (size_t i = begin; i + window <= times.size(); i += window)
        means.push_back(mean({times.begin() + static_cast<std::ptrdiff_t>(i),
                              times.begin() + static_cast<std::ptrdiff_t>(i + window)}));
    return median(means);
}

void write_times(const std::vector<double>& times, const StepPlan& plan, SceneRow& row) {
    const auto second = static_cast<size_t>(plan.rate);  // random steps last 1/53 s on average
    row.ms_mean = mean(times);
    row.ms_worst = *std::max_element(times.begin(), times.end());
    row.ms_median = median_of_windows(times, 0, plan);
    row.ms_median_last_second =
        median_of_windows(times, times.size() - std::min(times.size(), second), plan);
}

}  // namespace

SceneResult run_scene(const SceneRecipe& recipe, const SceneRunSettings& settings,
                      const SceneSolvers& solvers, const SceneProgress& progress) {
    const std::unique_ptr<btGnnSoftBodySolver> solver =
        solvers.make(settings.solver, defaults_of(recipe));
    SceneWorld scene(solver.get());
    recipe.build(scene);
    SceneProbe probe(scene);
    const SceneEnergyMeter energy(scene);
    SceneResult result;
    SceneRow& row = result.row;
    row.scene = recipe.name;
    row.solver = settings.solver;
    row.rate_hz = settings.steps.random ? 0 : settings.steps.rate;
    row.finite = true;
    row.rest_error_mm = row.rest_energy_mm = row.momentum_error = row.times_bullet = kNan;
    SceneMeters meters(recipe, scene, probe, solver.get());
    const std::vector<float> steps = step_lengths(settings.steps, settings.seconds);
    std::vector<double> times;
    int pictures = 0;
    for (size_t i = 0; i < steps.size() && row.finite; ++i) {
        times.push_back(milliseconds_of([&] { scene.step(steps[i]); }));
        row.finite = probe.finite();
        if (row.finite) meters.step();
        while (row.finite && pictures < settings.pictures_per_second * scene.time()) {
            result.pictures.push_back(probe.picture());
            ++pictures;
        }
        if (progress) progress(static_cast<int>(i) + 1, static_cast<int>(steps.size()));
    }
    meters.write(row);
    write_times(times, settings.steps, row);
    if (solver) row.cloth_bodies = solver->status().clothBodies;
    result.last = probe.cloth();
    result.others = probe.others();
    result.energy = energy.now();
    row.speed_end_mm_s = 1e3 * std::sqrt(2.0 * result.energy.kinetic);
    if (solver)
        for (const btGnnSolverMessage& message : solver->status().messages)
            result.messages.push_back(message.text);
    return result;
}

double shape_distance_mm(const std::vector<Points>& a, const std::vector<Points>& b) {
    double sum = 0.0, count = 0.0;
    for (size_t k = 0; k < a.size() && k < b.size(); ++k) {
        if (a[k].rows() != b[k].rows()) return kNan;
        sum += (a[k] - b[k]).squaredNorm();
        count += static_cast<double>(a[k].rows());
    }
    return count > 0.0 ? 1e3 * std::sqrt(sum / count) : kNan;
}

double energy_distance_mm(const SceneEnergy& a, const SceneEnergy& b) {
    constexpr double kGravity = 9.81;  // m/s^2, of all scenes
    return 1e3 * (a.potential - b.potential) / kGravity;
}

double momentum_error(const SceneRecipe& recipe, const SceneRunSettings& settings,
                      const SceneSolvers& solvers) {
    if (!recipe.launch) return kNan;
    const std::unique_ptr<btGnnSoftBodySolver> solver =
        solvers.make(settings.solver, defaults_of(recipe));
    SceneWorld scene(solver.get());
    recipe.build(scene);
    scene.closeSystem();
    recipe.launch(scene);
    SceneProbe probe(scene);
    const Vec3 before = probe.momentum();
    for (float h : step_lengths(settings.steps, 1.0)) scene.step(h);
    return (probe.momentum() - before).norm() / before.norm();
}

}  // namespace cloth
