#pragma once

#include <vector>

#include "data/body/body.h"
#include "data/body/skinning.h"
#include "gnn/skinning/skinning_config.h"

namespace cloth {

/// One pose as a skinning network sees it.
struct SeenPose {
    Eigen::Matrix3d root;  ///< rotation of the root in the world
    Vec3 root_position;    ///< (m)
    VectorX local;         ///< 6 of each other joint: two columns of its rotation relative to its
                           ///< parent, less those of the identity
};

/// Makes the input of a skinning network out of poses: where the joints are now, and how they moved
/// before. All of it is in the frame of the root, so that places and yaw make no difference.
///
/// | features                        | what                                                       |
/// |---------------------------------|------------------------------------------------------------|
/// | 3                               | direction of gravity; zero without any                     |
/// | 6 (joints - 1)                  | SeenPose::local of age 0                                   |
/// | 6 (joints - 1) for each age > 0 | local of that age, less that of age 0, per step            |
/// | 9 for each age > 0              | two columns of the root's rotation then, less those of the |
/// |                                 | identity, per step, and where it was then, per second (m/s)|
class PoseFeatures {
 public:
    /// @throws ArgumentError if the body has not the configuration's joints, or not in their order
    PoseFeatures(const SkinningConfig& config, const Body& body);

    const std::vector<int>& joints() const { return m_joints; }  ///< of the body: config.joints

    /// @param matrices  of the body's joints, from its rest pose
    SeenPose see(const std::vector<SkinMatrix>& matrices) const;

    /// @param poses    of the configuration's ages
    /// @param gravity  (m/s^2)
    void build(const std::vector<const SeenPose*>& poses, const Vec3& gravity,
               VectorX& features) const;

 private:
    std::vector<int> m_joints, m_parents;  ///< parents as indices of m_joints
    Vec3 m_root;                           ///< in the rest pose (m)
    std::vector<int> m_ages;
    double m_dt;
};

}  // namespace cloth
