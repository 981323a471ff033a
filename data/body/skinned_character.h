#pragma once

#include <string>
#include <vector>

#include "data/body/character_rig.h"
#include "data/core/moving_surface.h"

namespace cloth {

struct CharacterSettings {
    std::string animation;  ///< its name in the file; empty: the first one, if there is one
    std::string mesh_name;  ///< the mesh that is skin; empty: all meshes
    double scale = 1.0;  ///< file units to metres, where the file does not say itself, 1e-6 to 1e6
    double friction = 0.5;  ///< of the skin against cloth (Coulomb), 0 to 1.5
};

/// A character that a file brings with skeleton, skin weights and animation (glTF, COLLADA, FBX and
/// other formats that assimp reads). Without an animation it stands in the pose of the file, and
/// its duration() is 0.
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
    /// The skin as the file places it (|V| x 3, m), before any animation: the pose that garments
    /// are modelled on.
    Points rest_vertices() const;
    /// Where each joint moves the skin of rest_vertices() at `time` (s): what is worn on it, and
    /// has the skin's weights, comes along.
    std::vector<SkinMatrix> skin_matrices(double time) const;
    double duration() const override { return m_rig.duration; }

    /// Skeleton, skin weights and animation as the file has them.
    const CharacterRig& rig() const { return m_rig; }

 private:
    Eigen::Affine3d local_transform(const CharacterNode& node, double time) const;
    using Transforms = std::vector<Eigen::Affine3d>;
    Transforms local_transforms(double time) const;
    Transforms rest_transforms() const;
    Transforms joint_transforms(const Transforms& local) const;
    Points skin(const Transforms& local) const;

    CharacterRig m_rig;
    std::shared_ptr<const Faces> m_faces;
    double m_scale;
};

}  // namespace cloth
