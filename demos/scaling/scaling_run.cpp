#include "demos/scaling/scaling_run.h"

#include "demos/speed_error/contest.h"

namespace cloth {
namespace {

std::vector<Contestant> make_contestants(const ComparisonScene& scene, const ClothState& start,
                                         const ScalingSettings& settings) {
    std::vector<Contestant> contestants;
    for (const std::string& name : settings.solvers)
        contestants.push_back({name, make_warm(scene, start, [&] {
                                   return make_solver(name, scene, settings.solver);
                               })});
    return contestants;
}

}  // namespace

std::vector<ScalingRow> measure_size(const SizedSceneSettings& scene_settings,
                                     const ScalingSettings& settings,
                                     const ProgressFunction& progress) {
    const auto tell = [&](int done, int all, const std::string& what) {
        progress(
            done, all,
            scene_settings.name + ", " + std::to_string(scene_settings.vertices) + ": " + what);
    };
    tell(0, 1, "the garment is made");
    const std::unique_ptr<ComparisonScene> scene = make_sized_scene(scene_settings);
    // Converged steps, as references take them, would be most of the time of a large garment.
    const ClothState start =
        settle(*scene, *make_solver("quasi-newton-10", *scene, settings.solver), tell);
    tell(0, 1, "solvers warm up");
    const std::vector<Contestant> contestants = make_contestants(*scene, start, settings);
    const std::vector<Rollout> rollouts = roll_out(*scene, start, {}, contestants, tell);
    std::vector<ScalingRow> rows;
    for (size_t k = 0; k < rollouts.size(); ++k) {
        ScalingRow row = make_scaling_row(rollouts[k], settings.warm_up);
        row.scene = scene_settings.name;
        row.solver = settings.solvers[k];
        row.vertices = static_cast<int>(scene->garment().vertex_count());
        row.setup_ms = contestants[k].warm.setup_ms;
        row.memory_mb = contestants[k].warm.memory_mb;
        rows.push_back(row);
    }
    return rows;
}

}  // namespace cloth
