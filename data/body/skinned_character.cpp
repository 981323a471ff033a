#include "data/body/skinned_character.h"

#include <algorithm>
#include <utility>

#include "data/core/check_range.h"

namespace cloth {

namespace {

/// The keys around `time`: index of the first and the way to the next (0 to 1).
std::pair<size_t, double> find_key(const std::vector<double>& times, double time) {
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    if (after == times.begin()) return {0, 0.0};
    if (after == times.end()) return {times.size() - 1, 0.0};
    const auto k = static_cast<size_t>(after - times.begin()) - 1;
    return {k, (time - times[k]) / (times[k + 1] - times[k])};
}

Vec3 sample(const std::vector<double>& times, const std::vector<Vec3>& values, double time) {
    const auto [k, s] = find_key(times, time);
    return s > 0.0 ? Vec3((1.0 - s) * values[k] + s * values[k + 1]) : values[k];
}

Eigen::Quaterniond sample(const std::vector<double>& times,
                          const std::vector<Eigen::Quaterniond>& values, double time) {
    const auto [k, s] = find_key(times, time);
    return s > 0.0 ? values[k].slerp(s, values[k + 1]) : values[k];
}

}  // namespace

SkinnedCharacter::SkinnedCharacter(const std::string& path, const CharacterSettings& settings)
    : MovingSurface(settings.friction),
      m_rig(load_character_rig(path, settings.animation, settings.mesh_name)),
      m_faces(std::make_shared<const Faces>(m_rig.faces)),
      m_scale(settings.scale) {
    check_range("CharacterSettings.scale", settings.scale, 1e-6, 1e6);
    check_range("CharacterSettings.friction", settings.friction, 0.0, 1.5);
}

Eigen::Affine3d SkinnedCharacter::local_transform(const CharacterNode& node, double time) const {
    if (!node.track) return node.rest;
    const CharacterTrack& track = m_rig.tracks[*node.track];
    return Eigen::Translation3d(sample(track.position_times, track.positions, time)) *
           sample(track.rotation_times, track.rotations, time) *
           Eigen::Scaling(sample(track.scale_times, track.scales, time));
}

/// @param local  of each node, relative to its parent
Points SkinnedCharacter::skin(const std::vector<Eigen::Affine3d>& local) const {
    std::vector<Eigen::Affine3d> world;
    for (size_t n = 0; n < m_rig.nodes.size(); ++n) {
        const int parent = m_rig.nodes[n].parent;
        world.push_back(parent < 0 ? local[n] : world[parent] * local[n]);
    }
    std::vector<SkinMatrix> matrices;
    for (const CharacterJoint& joint : m_rig.joints)
        matrices.emplace_back(m_scale * (world[joint.node] * joint.offset).matrix().topRows<3>());
    return skin_points(m_rig.rest, m_rig.weights, matrices);
}

Points SkinnedCharacter::vertices(double time) const {
    std::vector<Eigen::Affine3d> local;
    for (const CharacterNode& node : m_rig.nodes) local.push_back(local_transform(node, time));
    return skin(local);
}

Points SkinnedCharacter::rest_vertices() const {
    std::vector<Eigen::Affine3d> local;
    for (const CharacterNode& node : m_rig.nodes) local.push_back(node.rest);
    return skin(local);
}

}  // namespace cloth
