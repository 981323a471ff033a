#pragma once

#include <memory>
#include <string>

#include "data/body/skinned_character.h"
#include "data/core/weld.h"

namespace cloth {

/// A character's skin as one surface: parts and texture seams that its file splits are joined in
/// every pose.
///
///     cloth::WeldedCharacter skin("dancer.glb", {}, 1e-4);
///     boundary.obstacles = {skin.obstacle(t, t + dt)};
class WeldedCharacter : public MovingSurface {
 public:
    /// @param tolerance  vertices as near as this in the pose of the file become one (m), 0 to 0.01
    /// @throws LoadError as SkinnedCharacter, ArgumentError if the tolerance is out of range
    WeldedCharacter(const std::string& path, const CharacterSettings& settings, double tolerance);

    /// As the file places it, before any animation: the pose that garments are modelled on.
    const TriMesh& rest() const { return m_rest.mesh; }
    const SkinWeights& weights() const { return m_weights; }  ///< of its vertices
    /// See SkinnedCharacter.
    std::vector<SkinMatrix> skin_matrices(double time) const {
        return m_character.skin_matrices(time);
    }
    double height() const;  ///< of that pose (m)
    /// Whether its animation changes morph targets, which are not read.
    bool has_unread_morphs() const { return m_character.rig().unread_morphs; }

    std::shared_ptr<const Faces> faces() const override { return m_faces; }
    Points vertices(double time) const override;
    double duration() const override { return m_character.duration(); }

 private:
    SkinnedCharacter m_character;
    WeldedMesh m_rest;
    SkinWeights m_weights;
    std::shared_ptr<const Faces> m_faces;
};

}  // namespace cloth
