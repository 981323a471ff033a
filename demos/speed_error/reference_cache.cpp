#include "demos/speed_error/reference_cache.h"

#include <algorithm>
#include <filesystem>

#include "data/files/make_folder.h"

namespace cloth {

/// Goes on with a trajectory to so many frames.
using Extension = std::function<Trajectory(Trajectory begun, int frames)>;

/// The trajectory in the file, extended as far as it is too short. What is computed is saved every
/// few frames, so that an interruption costs little.
static Trajectory kept(const std::string& file, const ClothState& start, int frames,
                       const Extension& extend) {
    constexpr int frames_between_saves = 5;
    Trajectory trajectory = {start};
    if (std::filesystem::exists(file)) trajectory = load_trajectory(file);
    for (int done = static_cast<int>(trajectory.size()) - 1; done < frames;) {
        done = std::min(frames, done + frames_between_saves);
        trajectory = extend(std::move(trajectory), done);
        save_trajectory(file, trajectory);
    }
    trajectory.resize(static_cast<size_t>(frames) + 1);
    return trajectory;
}

ReferenceCache::ReferenceCache(const std::string& folder, const std::string& name,
                               const ComparisonScene& scene)
    : m_scene(scene) {
    make_folder(folder);
    m_prefix = folder + "/" + name + "_" + std::to_string(scene.garment().vertex_count());
}

ClothState ReferenceCache::start(const ProgressFunction& progress) const {
    const std::string file = m_prefix + "_start.traj";
    if (!std::filesystem::exists(file)) save_trajectory(file, {settle(m_scene, progress)});
    return load_trajectory(file).at(0);
}

References ReferenceCache::references(const ClothState& start,
                                      const ProgressFunction& progress) const {
    const int frames = m_scene.reference_frames();
    const auto tell = [&](int done, int, const std::string& what) { progress(done, frames, what); };
    return {kept(m_prefix + "_reference.traj", start, frames,
                 [&](Trajectory begun, int end) {
                     return coarse_reference(m_scene, std::move(begun), end, tell);
                 }),
            kept(m_prefix + "_fine.traj", start, frames, [&](Trajectory begun, int end) {
                return fine_reference(m_scene, std::move(begun), end, tell);
            })};
}

}  // namespace cloth
