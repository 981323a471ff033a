#include "demos/bake/bake.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "data/files/cache_format.h"
#include "data/files/mesh_io.h"
#include "demos/compare/arguments.h"
#include "demos/dressing_checks.h"

namespace cloth {

namespace fs = std::filesystem;

namespace {

/// A finished cache must not be computed again by mistake.
void check_resume(const BakeOptions& options) {
    const auto is_begun = [](const std::string& path) {
        return !path.empty() && (cache_format(path) == CacheFormat::obj_sequence ||
                                 fs::exists(unfinished_cache(path)));
    };
    if (is_begun(options.out) || is_begun(options.body)) return;
    throw UsageError("--resume: there is no " + unfinished_cache(options.out) +
                     (fs::exists(options.out) ? ", and " + options.out + " is whole"
                                              : ": run without --resume"));
}

}  // namespace

std::vector<std::string> cache_files(const std::string& cache) {
    return {cache, unfinished_cache(cache), rest_file(cache)};
}

std::string rest_file(const std::string& cache) {
    fs::path path = fs::path(cache).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    return (path.parent_path() / path.stem()).string() + "_rest.obj";
}

std::vector<BakedMesh> open_caches(const BakeScene& scene, const BakeOptions& options) {
    if (options.resume) check_resume(options);
    const CacheSettings settings{static_cast<double>(options.rate), scene.frames()};
    const CacheStart start = options.resume ? CacheStart::go_on : CacheStart::anew;
    std::vector<BakedMesh> meshes;
    const auto open = [&](const std::string& path, const TriMesh& mesh) {
        std::error_code ignored;  // the writer says that the folder is missing
        fs::create_directories(fs::path(rest_file(path)).parent_path(), ignored);
        meshes.push_back({make_cache_writer(path, mesh, settings, start), nullptr});
        save_obj(rest_file(path), mesh);
    };
    open(options.out, scene.cloth->garment().rest());
    meshes.back().positions = [](const ClothState& state, double) { return state.x; };
    if (options.body.empty()) return meshes;
    open(options.body, scene.body);
    meshes.back().positions = [skin = scene.skin](const ClothState&, double time) {
        return skin(time);
    };
    return meshes;
}

bool bake(const BakeScene& scene, Stepper& stepper, std::vector<BakedMesh>& meshes,
          const BakeWatch& watch) {
    const double dt = scene.cloth->frame_time();
    const int lead_in = scene.cloth->lead_in_frames(), frames = scene.frames();
    ClothState state = scene.cloth->start();
    bool is_lost = false;
    for (int frame = -lead_in; frame < frames; ++frame) {
        if (frame >= 0)
            for (BakedMesh& mesh : meshes) mesh.cache->add(mesh.positions(state, frame * dt));
        const int settled = std::min(lead_in, frame + lead_in + 1);
        frame < 0 ? watch.progress(settled, lead_in, "the garment settles")
                  : watch.progress(frame + 1, frames, "frames");
        if (frame + 1 == frames) break;
        if (watch.interrupted()) return false;
        const Boundary boundary = scene.cloth->frame_boundary(frame);
        if (!stepper.step(boundary, dt, state).finite)
            throw std::runtime_error("the step after frame " + std::to_string(frame) +
                                     " failed: take another --solver, or fewer --frames");
        if (is_lost || !watch.lost) continue;
        const std::string problem = scene.cloth->loss(boundary, state.x);
        is_lost = !problem.empty();
        if (is_lost) watch.lost(frame + 1, problem);
    }
    for (BakedMesh& mesh : meshes) mesh.cache->finish();
    if (!is_lost && watch.lost) {
        const TriMesh skin{scene.skin((frames - 1) * dt), scene.body.faces};
        const std::string problem = worn_problem(worn_state(scene.cloth->garment(), state.x, skin));
        if (!problem.empty()) watch.lost(frames - 1, problem);
    }
    return true;
}

}  // namespace cloth
