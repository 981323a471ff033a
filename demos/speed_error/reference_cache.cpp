#include "demos/speed_error/reference_cache.h"

#include <filesystem>

namespace cloth {

/// What the file holds if that is long enough, else what `make` makes, kept in the file.
static Trajectory kept(const std::string& file, int frames,
                       const std::function<Trajectory()>& make) {
    const size_t states = static_cast<size_t>(frames) + 1;
    if (std::filesystem::exists(file)) {
        Trajectory trajectory = load_trajectory(file);
        if (trajectory.size() >= states) {
            trajectory.resize(states);
            return trajectory;
        }
    }
    Trajectory trajectory = make();
    save_trajectory(file, trajectory);
    return trajectory;
}

ReferenceCache::ReferenceCache(const std::string& folder, const std::string& name,
                               const ComparisonScene& scene)
    : m_scene(scene) {
    std::filesystem::create_directories(folder);
    m_prefix = folder + "/" + name + "_" + std::to_string(scene.garment().vertex_count());
}

ClothState ReferenceCache::start(const ProgressFunction& progress) const {
    const auto make = [&] { return Trajectory{settle(m_scene, progress)}; };
    return kept(m_prefix + "_start.traj", 0, make).front();
}

References ReferenceCache::references(const ClothState& start,
                                      const ProgressFunction& progress) const {
    const int frames = m_scene.reference_frames();
    return {kept(m_prefix + "_reference.traj", frames,
                 [&] { return coarse_reference(m_scene, start, progress); }),
            kept(m_prefix + "_fine.traj", frames,
                 [&] { return fine_reference(m_scene, start, progress); })};
}

}  // namespace cloth
