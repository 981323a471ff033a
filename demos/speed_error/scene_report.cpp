#include "demos/speed_error/scene_report.h"

#include <omp.h>

#include <algorithm>
#include <filesystem>

#include "demos/compare/input_files.h"
#include "demos/speed_error/reference_cache.h"

namespace cloth {
namespace {

using nlohmann::ordered_json;

ordered_json describe(const SceneSettings& settings, const ComparisonScene& scene) {
    const Boundary boundary = scene.frame_boundary(0);
    long obstacle_faces = 0;
    for (const Obstacle& obstacle : boundary.obstacles)
        if (obstacle.faces) obstacle_faces += static_cast<long>(obstacle.faces->rows());
    ordered_json json;
    json["scene"] = settings.name;
    json["description"] = scene_description(settings.name);
    json["fabric"] = settings.fabric;
    json["longitudinal_stiffness"] = scene.garment().fabric().longitudinal();  // N/m
    json["vertices"] = scene.garment().vertex_count();
    json["faces"] = scene.garment().face_count();
    json["obstacles"] = boundary.obstacles.size();
    json["obstacle_faces"] = obstacle_faces;
    json["frames"] = scene.frames();
    json["time_step"] = scene.frame_time();
    json["limbs"] = scene.has_limbs();
    return json;
}

/// All solvers, so that a name that cannot be used is known before the expensive part begins.
std::vector<Contestant> make_contestants(const ComparisonScene& scene, const ClothState& start,
                                         const ContestSettings& settings,
                                         const ProgressFunction& progress) {
    std::vector<Contestant> contestants;
    for (const std::string& name : settings.solvers) {
        const auto make = [&] { return make_solver(name, scene, settings.solver); };
        contestants.push_back({name, make_warm(scene, start, make)});
        progress(static_cast<int>(contestants.size()), static_cast<int>(settings.solvers.size()),
                 "solvers warm up");
    }
    return contestants;
}

/// The times of the solver that others are compared with; empty if it does not take part.
std::vector<double> times_of(const std::string& name, const std::vector<std::string>& solvers,
                             const std::vector<ContestResult>& results) {
    const auto at = std::find(solvers.begin(), solvers.end(), name);
    if (at == solvers.end()) return {};
    return results[static_cast<size_t>(at - solvers.begin())].rollout.ms;
}

/// What its references are kept under: scenes of files are told apart by what these hold.
std::string cache_name(const SceneSettings& settings) {
    const std::vector<std::string> files = garment_files(settings.name);
    return (files.empty() ? settings.name : std::filesystem::path(settings.name).stem().string()) +
           "_" + settings.fabric + "_" + std::to_string(settings.rate) + "Hz_" + settings.body +
           "_" + std::filesystem::path(settings.motion).stem().string() +
           (settings.limbs ? "_limbs" : "") +
           short_key(scene_files(settings.name, settings.motion));
}

}  // namespace

SceneReport measure_scene(const SceneSettings& scene_settings, const ContestSettings& settings,
                          const ProgressFunction& progress) {
    const std::string name = cache_name(scene_settings);
    const auto tell = [&](int done, int all, const std::string& what) {
        progress(done, all, scene_settings.name + ", " + scene_settings.fabric + ": " + what);
    };
    const std::unique_ptr<ComparisonScene> scene = make_scene(scene_settings);
    const ReferenceCache cache(settings.work, name, *scene);
    const ClothState start = cache.start(tell);
    const std::vector<Contestant> contestants = make_contestants(*scene, start, settings, tell);
    const References references = cache.references(start, tell);
    const std::vector<ContestResult> results =
        run_contest(*scene, start, references, contestants, tell);

    SceneReport report{describe(scene_settings, *scene), {}};
    const std::vector<double> others = times_of(settings.relative_to, settings.solvers, results);
    for (size_t k = 0; k < results.size(); ++k) {
        SolverRow row = make_row(settings.solvers[k], results[k], others);
        row.scene = scene_settings.name;
        row.fabric = scene_settings.fabric;
        row.network = network_facts(row.solver, settings.solver);
        row.threads = omp_get_max_threads();
        row.peak_memory_mb = contestants[k].warm.memory_mb;
        if (report.description["obstacles"] == 0) row.penetration_max_mm = SolverRow::none;
        report.rows.push_back(row);
    }
    return report;
}

}  // namespace cloth
