#pragma once

#include <vector>

#include "data/body/body.h"
#include "data/body/motion.h"

namespace cloth {

/// A pose in the body's own skeleton.
struct BodyPose {
    Vec3 root_position = Vec3::Zero();          ///< of joint 0 (m)
    std::vector<Eigen::Quaterniond> rotations;  ///< |joints|: relative to the parent; identity at
                                                ///< rest, all joint frames parallel to the world
};

/// The pose of `body` at rest.
BodyPose rest_pose(const Body& body);

/// Where a pose moves the skin.
JointTransforms joint_transforms(const Body& body, const BodyPose& pose);

struct RetargetSettings {
    bool align_heading = true;  ///< turn and shift the motion so that its first frame faces +z with
                                ///< the hips above the body's own
    bool ground_feet = true;    ///< lift or lower the motion so that its soles touch y = 0
};

/// One pose per frame of the motion. Rotations are transferred, lengths are the body's own; the
/// root's way is scaled by the ratio of the legs' lengths.
///
/// At any time a joint's world rotation R takes the motion figure's rest directions to the current
/// ones. The body rests in another pose (arms down, feet level), so it gets R A, where the constant
/// A takes the body's rest directions to the figure's: for arms and legs the smallest rotation of
/// each bone onto its counterpart (relative to the bone above, so that elbows and knees bend about
/// their own axes); for the feet what makes level soles of the body level soles of the figure; for
/// the trunk the tilt that the figure's joints have in upright walking.
///
/// Known figures: CMU's (any of its BVH conversions) and the one with Hip, Knee and Elbow joints of
/// Boxing_Toes. Joints that the figure lacks stay stiff with their parents.
/// @throws LoadError naming the motion and the joints that it lacks
std::vector<BodyPose> retarget(const Body& body, const Motion& motion,
                               const RetargetSettings& settings = {});

}  // namespace cloth
