#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// How much each vertex follows each joint: few joints per vertex, weights that sum to 1, the
/// largest first. The influences of vertex i are entries begin[i] to begin[i + 1] - 1.
struct SkinWeights {
    std::vector<int> begin;      ///< |V| + 1
    std::vector<int> joints;     ///< joint of each influence
    std::vector<double> values;  ///< weight of each influence, above 0

    int vertex_count() const { return static_cast<int>(begin.size()) - 1; }
    /// Weight of joint `joint` on vertex `vertex`, 0 if it has none.
    double at(int vertex, int joint) const;
    /// Joint with the largest weight, per vertex.
    std::vector<int> dominant_joints() const;
};

/// Keeps the `max_influences` largest weights above `threshold` of each row and normalises them.
/// @param dense  |V| x |joints|, not negative, each row with a positive sum
SkinWeights sparse_weights(const Eigen::MatrixXd& dense, int max_influences, double threshold);

/// A straight bone inside the body, stiff with one joint.
struct BoneSegment {
    int joint = 0;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< (m)
};

struct HeatWeightSettings {
    double heat = 3.0;         ///< 0.1 to 10: larger makes narrower transitions between joints
    int max_influences = 6;    ///< joints per vertex, 1 to 8
    double threshold = 0.005;  ///< weights below are dropped, 0 to 0.1
};

/// Skin weights by heat diffusion over the surface (Baran and Popovic 2007, "Automatic rigging and
/// animation of 3D characters", section 4): for each joint j solve
///
///     (L + M H) w_j = M H p_j
///
/// with the cotangent Laplacian L, vertex areas M, H = heat / d^2 for the distance d to the nearest
/// bone that the vertex sees, and p_j = 1 where that bone moves with joint j. A vertex sees a bone
/// if the way to it starts inwards and does not leave the body: so the flank does not follow the
/// arm beside it.
/// @param bones  inside the body; at least one
/// @throws ArgumentError if there are no faces or no bones, or the system cannot be solved
SkinWeights heat_weights(const TriMesh& skin, const std::vector<BoneSegment>& bones,
                         int joint_count, const HeatWeightSettings& settings = {});

}  // namespace cloth
