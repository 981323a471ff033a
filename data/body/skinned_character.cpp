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

SkinnedCharacter::Transforms SkinnedCharacter::local_transforms(double time) const {
    Transforms local;
    for (const CharacterNode& node : m_rig.nodes) local.push_back(local_transform(node, time));
    return local;
}

SkinnedCharacter::Transforms SkinnedCharacter::rest_transforms() const {
    Transforms local;
    for (const CharacterNode& node : m_rig.nodes) local.push_back(node.rest);
    return local;
}

/// From the frames of the meshes to the world, in the file's units.
/// @param local  of each node, relative to its parent
SkinnedCharacter::Transforms SkinnedCharacter::joint_transforms(const Transforms& local) const {
    Transforms world, joints;
    for (size_t n = 0; n < m_rig.nodes.size(); ++n) {
        const int parent = m_rig.nodes[n].parent;
        world.push_back(parent < 0 ? local[n] : world[parent] * local[n]);
    }
    for (const CharacterJoint& joint : m_rig.joints)
        joints.push_back(world[joint.node] * joint.offset);
    return joints;
}

Points SkinnedCharacter::skin(const Transforms& local) const {
    std::vector<SkinMatrix> matrices;
    for (const Eigen::Affine3d& joint : joint_transforms(local))
        matrices.emplace_back(m_scale * joint.matrix().topRows<3>());
    return skin_points(m_rig.rest, m_rig.weights, matrices);
}

std::vector<SkinMatrix> SkinnedCharacter::skin_matrices(double time) const {
    const Transforms from = joint_transforms(rest_transforms());
    const Transforms to = joint_transforms(local_transforms(time));
    std::vector<SkinMatrix> matrices;
    for (size_t j = 0; j < from.size(); ++j) {
        SkinMatrix matrix = (to[j] * from[j].inverse()).matrix().topRows<3>();
        matrix.col(3) *= m_scale;
        matrices.push_back(matrix);
    }
    return matrices;
}

Points SkinnedCharacter::vertices(double time) const {
    return skin(local_transforms(time));
}

Points SkinnedCharacter::rest_vertices() const {
    return skin(rest_transforms());
}

}  // namespace cloth
