#pragma once

#include <string>
#include <vector>

#include "data/moving_surface.h"
#include "data/skinning.h"

namespace cloth {

struct CharacterSettings {
    std::string animation;  ///< its name in the file; empty: the first one
    std::string mesh_name;  ///< the mesh that is skin; empty: all meshes
    double scale = 1.0;     ///< file units to metres, where the file does not say itself
    double friction = 0.5;  ///< of the skin against cloth (Coulomb), 0 to 1.5
};

/// A character that a file brings with skeleton, skin weights and animation (glTF, COLLADA, FBX and
/// other formats that assimp reads).
///
///     const SkinnedCharacter character("dancer.gltf");
///     boundary.obstacles = {character.obstacle(t, t + dt)};
class SkinnedCharacter : public MovingSurface {
 public:
    /// @throws LoadError if the file cannot be read or has no such mesh or animation, if its bones
    ///         name joints that do not exist, or if its numbers are not finite
    explicit SkinnedCharacter(const std::string& path, const CharacterSettings& settings = {});

    std::shared_ptr<const Faces> faces() const override { return m_faces; }
    Points vertices(double time) const override;
    double duration() const override { return m_duration; }

    const SkinWeights& weights() const { return m_weights; }
    /// Names of the joints that `weights()` counts (a bone of two meshes is two joints).
    const std::vector<std::string>& joint_names() const { return m_joint_names; }

 private:
    friend class CharacterReader;

    /// Values over time, interpolated linearly (rotations: spherically).
    struct Track {
        std::vector<double> position_times, rotation_times, scale_times;  ///< (s)
        std::vector<Vec3> positions, scales;
        std::vector<Eigen::Quaterniond> rotations;
    };
    /// A node of the file's scene; parents come first.
    struct Node {
        int parent = -1;
        Eigen::Affine3d rest = Eigen::Affine3d::Identity();  ///< relative to the parent
        int track = -1;                                      ///< -1: it does not move
    };
    /// What weights refer to: a node, and the map from the mesh's frame to the node's at binding.
    struct Binding {
        int node = 0;
        Eigen::Affine3d offset = Eigen::Affine3d::Identity();
    };

    Eigen::Affine3d local_transform(const Node& node, double time) const;

    std::vector<Node> m_nodes;
    std::vector<Track> m_tracks;
    std::vector<Binding> m_bindings;
    std::vector<std::string> m_joint_names;
    SkinWeights m_weights;
    Points m_rest;  ///< in the frames of the meshes
    std::shared_ptr<const Faces> m_faces;
    double m_scale = 1.0;
    double m_duration = 0.0;
};

}  // namespace cloth
