#pragma once

#include <functional>
#include <vector>

#include "data/body/animated_body.h"
#include "data/body/skinning.h"
#include "data/body/welded_character.h"
#include "data/core/mesh.h"
#include "data/core/skin_goals.h"

namespace cloth {

/// A copy of a garment that is skinned like the character that wears it: where each vertex would be
/// if the garment were painted on. Its places and normals are goals for the cloth, see GoalLimits.
///
///     const GarmentSkinning skinning = skin_garment(start.x, body);
///     boundary.goals = skinned_goals(skinning, body, t, t + dt);
///
/// Each vertex takes the mean weights of the skin around its nearest point, smoothly over 3 cm, and
/// follows the joints by linear blend skinning. Its normal is the outward one of the skin there, so
/// that "behind" is towards the body whichever way the faces of the garment turn.
class GarmentSkinning {
 public:
    /// @param worn     |V| x 3 (m): the garment as worn on `skin`
    /// @param skin     in the pose that the joints' transforms start from (m), outward faces
    /// @param weights  of the skin's vertices
    /// @throws ArgumentError if the skin has no face, the weights are not its own or a number is
    /// not
    ///         finite
    GarmentSkinning(Points worn, const TriMesh& skin, const SkinWeights& weights);

    /// The garment with the joints moved.
    /// @param matrices  from the skin's pose to another, one per joint that the weights name
    /// @param x         |V| x 3 (m)
    /// @param normals   |V| x 3, unit
    /// @throws ArgumentError if a joint has no matrix
    void pose(const std::vector<SkinMatrix>& matrices, Points& x, Points& normals) const;

    const SkinWeights& weights() const { return m_weights; }  ///< of the garment's vertices
    const Points& worn() const { return m_worn; }             ///< |V| x 3 (m)
    const Points& normals() const { return m_normals; }       ///< |V| x 3, as worn
    /// How far the farthest vertex is from its nearest vertex of the skin (m).
    double farthest() const { return m_farthest; }

 private:
    Points m_worn, m_normals;
    SkinWeights m_weights;
    int m_joints = 0;  ///< that the weights name: one more than the last
    double m_farthest = 0.0;
};

/// Of a garment on a body's rest pose.
/// @throws ArgumentError as the constructor
GarmentSkinning skin_garment(const Points& worn, const AnimatedBody& body);
/// Of a garment on the pose of a character's file.
GarmentSkinning skin_garment(const Points& worn, const WeldedCharacter& character);

/// Goals of a step from t0 to t1 (s).
SkinGoals skinned_goals(const GarmentSkinning& skinning, const AnimatedBody& body, double t0,
                        double t1);
SkinGoals skinned_goals(const GarmentSkinning& skinning, const WeldedCharacter& character,
                        double t0, double t1);

/// Calls `use` with each garment vertex, each vertex of the skin around its nearest one, and that
/// one's weight; the weights of a garment vertex sum to 1. Smooth over 3 cm of skin.
/// @param garment, skin  |V| x 3 (m)
void for_each_skin_neighbour(const Points& garment, const Points& skin,
                             const std::function<void(Eigen::Index, Eigen::Index, double)>& use);

}  // namespace cloth
