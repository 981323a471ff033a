#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "data/body/rig_recipe.h"
#include "data/body/skin_weights.h"

namespace cloth {

/// Where each joint moves the skin: x' = transforms[j] * x takes a point that is stiff with joint j
/// from the rest pose to the pose (both in the world). Identities are the rest pose.
using JointTransforms = std::vector<Eigen::Isometry3d>;

struct Joint {
    std::string name;              ///< as in the CMU skeleton: Hips, LeftUpLeg, ...
    int parent = -1;               ///< -1 for the root; parents come first
    Vec3 position = Vec3::Zero();  ///< in the rest pose (m)
};

/// A person's skin with a skeleton in it: all that does not change when the body moves.
///
///     const Body body = Body::load_default();
///     const Points posed = body.skin(transforms);
class Body {
 public:
    /// Debian's human.zae (A-pose, 1.66 m, soles on y = 0, facing +z), rigged by
    /// data/assets/body_rig.json with the 25 joints of the CMU skeleton that move skin.
    /// @throws LoadError if the mesh or the recipe cannot be used
    static Body load_default();

    /// Rigs a skin by a recipe; weights by heat diffusion.
    /// @throws ArgumentError if the recipe is for another mesh
    Body(TriMesh rest, RigRecipe recipe);

    /// The same person in another shape: same faces, weights and order, joints where the recipe
    /// puts them in the new skin.
    /// @param rest  |V| x 3 (m)
    /// @throws ArgumentError if the number of vertices differs or one is not finite
    Body with_rest(const Points& rest) const;

    const Points& rest() const { return m_rest; }                          ///< |V| x 3 (m)
    const std::shared_ptr<const Faces>& faces() const { return m_faces; }  ///< |F| x 3
    TriMesh rest_mesh() const { return {m_rest, *m_faces}; }
    const std::vector<Joint>& joints() const { return m_joints; }
    const std::vector<BoneSegment>& bones() const { return m_bones; }  ///< in the rest pose
    const SkinWeights& weights() const { return *m_weights; }
    /// Joint that moves each vertex most (|V|).
    std::vector<int> dominant_joint() const { return m_weights->dominant_joints(); }

    /// Limb of each face (|F|): trunk, head, upper and lower half of each arm and leg.
    std::shared_ptr<const std::vector<std::uint8_t>> limbs() const { return m_limbs; }

    /// Index of the joint called `name`.
    /// @throws ArgumentError if there is none
    int joint(const std::string& name) const;
    /// Place of a named point of the recipe in the rest pose (m), for example "HeadTop".
    /// @throws ArgumentError if there is none
    Vec3 point(const std::string& name) const;
    /// Rest length of thigh and shin, mean of both sides (m).
    double leg_length() const;

    /// Vertices (|V| x 3, m) in a pose: linear blend skinning.
    /// @param transforms  |joints|
    Points skin(const JointTransforms& transforms) const;

 private:
    void place_joints();
    void name_limbs();

    Points m_rest;
    std::shared_ptr<const Faces> m_faces;
    std::shared_ptr<const RigRecipe> m_recipe;
    std::shared_ptr<const SkinWeights> m_weights;
    std::shared_ptr<const std::vector<std::uint8_t>> m_limbs;
    std::vector<Joint> m_joints;
    std::vector<BoneSegment> m_bones;
};

}  // namespace cloth
