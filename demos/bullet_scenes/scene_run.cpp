#include "demos/bullet_scenes/scene_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

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

/// Median over the means of successive windows of 1/30 s, from step `begin` on.
double median_of_windows(const std::vector<double>& times, size_t begin, int rate) {
    const auto window = static_cast<size_t>(std::max(1, rate / 30));
    std::vector<double> means;
    for (size_t i = begin; i + window <= times.size(); i += window)
        means.push_back(mean({times.begin() + static_cast<std::ptrdiff_t>(i),
                              times.begin() + static_cast<std::ptrdiff_t>(i + window)}));
    return median(means);
}

}  // namespace

SceneResult run_scene(const SceneRecipe& recipe, const SceneRunSettings& settings,
                      const SceneSolvers& solvers, const SceneProgress& progress) {
    const std::unique_ptr<btGnnSoftBodySolver> solver = solvers.make(settings.solver);
    SceneWorld scene(solver.get());
    recipe.build(scene);
    SceneProbe probe(scene);
    const SceneEnergyMeter energy(scene);
    SceneResult result;
    SceneRow& row = result.row;
    row.scene = recipe.name;
    row.solver = settings.solver;
    row.rate_hz = settings.rate;
    row.finite = true;
    row.rest_error_mm = row.rest_energy_mm = row.momentum_error = kNan;
    const int steps = static_cast<int>(std::lround(settings.seconds * settings.rate));
    const btScalar h = 1 / static_cast<btScalar>(settings.rate);
    std::vector<double> times;
    int pictures = 0;
    for (int i = 0; i < steps && row.finite; ++i) {
        times.push_back(milliseconds_of([&] { scene.step(h); }));
        row.finite = probe.finite();
        if (row.finite)
            row.penetration_max_mm = std::max(row.penetration_max_mm, 1e3 * probe.deepest());
        while (row.finite && pictures < settings.pictures_per_second * scene.time()) {
            result.pictures.push_back(probe.picture());
            ++pictures;
        }
        if (progress) progress(i + 1, steps);
    }
    const auto last = std::min<size_t>(times.size(), static_cast<size_t>(settings.rate));
    row.ms_median = median_of_windows(times, 0, settings.rate);
    row.ms_median_last_second = median_of_windows(times, times.size() - last, settings.rate);
    result.last = probe.cloth();
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
    const std::unique_ptr<btGnnSoftBodySolver> solver = solvers.make(settings.solver);
    SceneWorld scene(solver.get());
    recipe.build(scene);
    scene.closeSystem();
    recipe.launch(scene);
    SceneProbe probe(scene);
    const Vec3 before = probe.momentum();
    for (int i = 0; i < settings.rate; ++i) scene.step(1 / static_cast<btScalar>(settings.rate));
    return (probe.momentum() - before).norm() / before.norm();
}

}  // namespace cloth
