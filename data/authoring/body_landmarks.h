#pragma once

#include "data/body/body.h"

namespace cloth {

/// The points of a body that garments are cut by (m), in its rest pose: it stands upright (y up)
/// and faces +z, its left side is +x. What is given for the left side holds, mirrored, for the
/// right one.
struct BodyLandmarks {
    static constexpr int count = 10;

    Vec3 shoulder = Vec3::Zero();  ///< centre of the left shoulder joint
    Vec3 elbow = Vec3::Zero();     ///< centre of the left elbow
    Vec3 wrist = Vec3::Zero();     ///< centre of the left wrist
    Vec3 armpit = Vec3::Zero();    ///< top of the fold between left arm and chest
    Vec3 neck = Vec3::Zero();      ///< centre of the neck opening
    Vec3 waist = Vec3::Zero();     ///< where trousers and skirts are worn
    Vec3 hip = Vec3::Zero();       ///< centre of the left hip joint
    Vec3 crotch = Vec3::Zero();    ///< lowest point of the trunk
    Vec3 knee = Vec3::Zero();      ///< centre of the left knee
    Vec3 ankle = Vec3::Zero();     ///< centre of the left ankle
};

/// The other side's point of the left side's, if `side` is -1; the same if it is 1.
inline Vec3 mirrored(const Vec3& left, double side) {
    return {side * left.x(), left.y(), left.z()};
}

/// Joints are the body's own; armpit and neck opening lie where they are on the default body,
/// relative to shoulder and neck joints and the length of the upper arm.
/// @throws ArgumentError if the body lacks a joint, or its legs do not part
BodyLandmarks body_landmarks(const Body& body);

}  // namespace cloth
