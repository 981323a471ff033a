#include "data/body/retarget.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "data/core/errors.h"
#include "data/core/pose.h"

namespace cloth {

namespace {

using Eigen::Quaterniond;

constexpr double degree = M_PI / 180.0;

/// Names that a kind of figure gives to the body's joints, where they differ.
struct Figure {
    std::map<std::string, std::string> names;  ///< body joint -> figure joint; "" if it has none
    std::map<std::string, double> tilts;       ///< forward tilt in upright walking (degrees)
    std::string scheme;                        ///< of its names, for messages
};

/// The CMU skeleton. Tilts: mean world rotation about the lateral axis, relative to the heading,
/// over 16 walking clips of as many subjects (1908 frames); all other components were below 3
/// degrees. The neck's joints zigzag because markers, not vertebrae, defined them.
Figure cmu_figure() {
    return {{},
            {{"Hips", 4.5},
             {"LowerBack", 6.5},
             {"Spine", 5.5},
             {"Spine1", 3.5},
             {"LeftShoulder", 3.5},
             {"RightShoulder", 3.5},
             {"Neck", -8.0},
             {"Neck1", 11.0},
             {"Head", 19.0}},
            "the CMU skeleton (Hips, LeftUpLeg, LeftLeg, ...)"};
}

Figure hip_knee_figure() {
    Figure figure;
    figure.scheme = "Boxing_Toes (Hips, LeftHip, LeftKnee, ...)";
    figure.names = {{"LowerBack", "Ab"}, {"Spine", ""}, {"Spine1", "Chest"}, {"Neck1", ""}};
    for (const std::string side : {"Left", "Right"}) {
        figure.names[side + "UpLeg"] = side + "Hip";
        figure.names[side + "Leg"] = side + "Knee";
        figure.names[side + "Foot"] = side + "Ankle";
        figure.names[side + "ToeBase"] = side + "Toes";
        figure.names[side + "Shoulder"] = side + "Collar";
        figure.names[side + "Arm"] = side + "Shoulder";
        figure.names[side + "ForeArm"] = side + "Elbow";
        figure.names[side + "Hand"] = "";
        figure.names[side + "FingerBase"] = side + "Wrist";
    }
    return figure;
}

/// For each body joint the motion's, if the figure has one.
using JointMatches = std::vector<std::optional<int>>;

/// The missing names go to `missing`.
JointMatches match(const Body& body, const Skeleton& skeleton, const Figure& figure,
                   std::vector<std::string>& missing) {
    JointMatches matches;
    for (const Joint& joint : body.joints()) {
        const auto renamed = figure.names.find(joint.name);
        const std::string name = renamed == figure.names.end() ? joint.name : renamed->second;
        matches.push_back(name.empty() ? std::nullopt : skeleton.find(name));
        if (!name.empty() && !matches.back()) missing.push_back(name);
    }
    return matches;
}

struct Match {
    Figure figure;
    JointMatches joints;
};

Match find_figure(const Body& body, const Motion& motion) {
    std::vector<std::string> nearest;  // lacks of the scheme of which most is there
    std::string scheme;
    size_t most = 0;
    for (const Figure& figure : {cmu_figure(), hip_knee_figure()}) {
        std::vector<std::string> missing;
        JointMatches joints = match(body, motion.skeleton, figure, missing);
        if (missing.empty()) return {figure, std::move(joints)};
        const auto there = static_cast<size_t>(std::count_if(
            joints.begin(), joints.end(), [](const auto& joint) { return joint.has_value(); }));
        if (!scheme.empty() && there <= most) continue;
        nearest = missing;
        scheme = figure.scheme;
        most = there;
    }
    std::string list;
    for (const std::string& name : nearest) list += " " + name;
    throw LoadError(motion.source.empty() ? motion.name : motion.source, "joint names",
                    "the skeleton is unknown; it lacks the joints" + list,
                    "rename the joints as in " + scheme);
}

/// Rest directions of the figure's limbs: from a joint to the joint of the next limb.
class FigureRest {
 public:
    FigureRest(const Body& body, const Motion& motion, const JointMatches& joints)
        : m_body(body), m_joints(joints) {
        MotionFrame rest;
        rest.rotations.assign(motion.skeleton.joint_count(), Quaterniond::Identity());
        m_positions = joint_positions(motion.skeleton, rest);
    }

    Vec3 position(const std::string& name) const {
        return m_positions.row(m_joints[m_body.joint(name)].value());
    }
    Vec3 direction(const std::string& from, const std::string& to) const {
        return position(to) - position(from);
    }
    double length(const std::string& from, const std::string& to) const {
        return direction(from, to).norm();
    }

 private:
    const Body& m_body;
    const JointMatches& m_joints;
    Points m_positions;
};

Vec3 body_direction(const Body& body, const std::string& from, const std::string& to) {
    return body.joints()[body.joint(to)].position - body.joints()[body.joint(from)].position;
}

/// The constants A, one per body joint.
std::vector<Quaterniond> rest_alignments(const Body& body, const Figure& figure,
                                         const FigureRest& rest) {
    std::vector<Quaterniond> align(body.joints().size(), Quaterniond::Identity());
    const auto at = [&](const std::string& name) -> Quaterniond& {
        return align[body.joint(name)];
    };
    for (const auto& [name, tilt] : figure.tilts)
        at(name) = Eigen::AngleAxisd(-tilt * degree, Vec3::UnitX());

    const auto align_bone = [&](const std::string& above, const std::string& bone,
                                const std::string& tip) {
        const Quaterniond start = above.empty() ? Quaterniond::Identity() : at(above);
        at(bone) =
            rotation_between(start * body_direction(body, bone, tip), rest.direction(bone, tip)) *
            start;
    };
    for (const std::string side : {"Left", "Right"}) {
        align_bone("", side + "UpLeg", side + "Leg");
        align_bone(side + "UpLeg", side + "Leg", side + "Foot");
        align_bone("", side + "Arm", side + "ForeArm");
        align_bone(side + "Arm", side + "ForeArm", side + "FingerBase");
        at(side + "Hand") = at(side + "FingerBase") = at(side + "ForeArm");
        // Level soles: undo the sideways spread of the figure's legs at rest.
        at(side + "Foot") = at(side + "ToeBase") =
            rotation_between(-Vec3::UnitY(), rest.direction(side + "Leg", side + "Foot"));
    }
    return align;
}

/// Turn about the vertical that makes a rotated body face +z.
Quaterniond undo_heading(const Quaterniond& hips) {
    const Vec3 forward = hips * Vec3::UnitZ();
    return Quaterniond(Eigen::AngleAxisd(-std::atan2(forward.x(), forward.z()), Vec3::UnitY()));
}

/// World rotations of the body's joints; joints without counterpart follow their parents.
std::vector<Quaterniond> body_rotations(const Body& body, const JointMatches& matches,
                                        const std::vector<Quaterniond>& align,
                                        const std::vector<Quaterniond>& motion_world) {
    std::vector<Quaterniond> world(matches.size());
    for (size_t j = 0; j < matches.size(); ++j)
        world[j] = matches[j] ? (motion_world[*matches[j]] * align[j]).normalized()
                              : world[body.joints()[j].parent];
    return world;
}

BodyPose local_pose(const Body& body, const std::vector<Quaterniond>& world, const Vec3& root) {
    BodyPose pose{root, world};
    for (size_t j = 0; j < world.size(); ++j) {
        const int parent = body.joints()[j].parent;
        if (parent >= 0) pose.rotations[j] = world[parent].conjugate() * world[j];
    }
    return pose;
}

/// Skin vertices close to the ground at rest: the soles, a few of them.
std::vector<int> sole_vertices(const Body& body) {
    constexpr double height = 0.015;  // m
    constexpr int stride = 7;
    std::vector<int> soles;
    const double ground = body.rest().col(1).minCoeff();
    int met = 0;
    for (Eigen::Index i = 0; i < body.rest().rows(); ++i)
        if (body.rest()(i, 1) < ground + height && met++ % stride == 0)
            soles.push_back(static_cast<int>(i));
    return soles;
}

double lowest_sole(const Body& body, const std::vector<int>& soles,
                   const std::vector<int>& dominant, const BodyPose& pose) {
    const JointTransforms transforms = joint_transforms(body, pose);
    double lowest = std::numeric_limits<double>::infinity();
    for (int i : soles) {
        const Vec3 x = body.rest().row(i);
        lowest = std::min(lowest, (transforms[dominant[i]] * x).y());
    }
    return lowest;
}

/// Shifts all poses so that the soles' lowest height over time (its 5th percentile: a motion may
/// jump, and single frames may dip) is that of the rest pose.
void ground(const Body& body, std::vector<BodyPose>& poses) {
    const std::vector<int> soles = sole_vertices(body);
    const std::vector<int> dominant = body.dominant_joint();
    std::vector<double> heights;
    for (const BodyPose& pose : poses) heights.push_back(lowest_sole(body, soles, dominant, pose));
    const size_t rank = heights.size() / 20;
    std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(rank),
                     heights.end());
    const double shift = body.rest().col(1).minCoeff() - heights[rank];
    for (BodyPose& pose : poses) pose.root_position.y() += shift;
}

}  // namespace

BodyPose rest_pose(const Body& body) {
    return {body.joints()[0].position,
            std::vector<Quaterniond>(body.joints().size(), Quaterniond::Identity())};
}

JointTransforms joint_transforms(const Body& body, const BodyPose& pose) {
    const std::vector<Joint>& joints = body.joints();
    JointTransforms transforms(joints.size());
    for (size_t j = 0; j < joints.size(); ++j) {
        const int parent = joints[j].parent;
        const Eigen::Matrix3d local = pose.rotations[j].toRotationMatrix();
        const Eigen::Matrix3d turn =
            parent < 0 ? local : Eigen::Matrix3d(transforms[parent].linear() * local);
        const Vec3 position =
            parent < 0 ? pose.root_position : Vec3(transforms[parent] * joints[j].position);
        transforms[j] = Eigen::Isometry3d::Identity();
        transforms[j].linear() = turn;
        transforms[j].translation() = position - turn * joints[j].position;
    }
    return transforms;
}

std::vector<BodyPose> retarget(const Body& body, const Motion& motion,
                               const RetargetSettings& settings) {
    const Match found = find_figure(body, motion);
    const FigureRest rest(body, motion, found.joints);
    const std::vector<Quaterniond> align = rest_alignments(body, found.figure, rest);
    const double leg =
        0.5 * (rest.length("LeftUpLeg", "LeftLeg") + rest.length("LeftLeg", "LeftFoot") +
               rest.length("RightUpLeg", "RightLeg") + rest.length("RightLeg", "RightFoot"));
    if (!(leg > 0.0))
        throw LoadError(motion.source, "joint offsets", "the legs have no length",
                        "export the motion with its skeleton's offsets");
    const double scale = body.leg_length() / leg;

    std::vector<BodyPose> poses;
    Quaterniond turn = Quaterniond::Identity();
    Vec3 shift = Vec3::Zero();
    for (const MotionFrame& frame : motion.frames) {
        std::vector<Quaterniond> world =
            body_rotations(body, found.joints, align, world_rotations(motion.skeleton, frame));
        if (poses.empty() && settings.align_heading) {
            turn = undo_heading(world[0]);
            const Vec3 start = scale * (turn * frame.root_position);
            shift = body.joints()[0].position - start;
            shift.y() = 0.0;
        }
        for (Quaterniond& rotation : world) rotation = turn * rotation;
        poses.push_back(local_pose(body, world, scale * (turn * frame.root_position) + shift));
    }
    if (settings.ground_feet) ground(body, poses);
    return poses;
}

}  // namespace cloth
