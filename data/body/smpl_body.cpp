#include "data/body/smpl_body.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "data/body/ease.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr int body_joints = 22;    // pelvis to wrists, in all of these models
constexpr int finger_joints = 30;  // at the end of SMPL+H and SMPL-X

bool has_fingers(int joints) {
    return joints == 52 || joints == 55;
}

/// For each joint of the model that of the motion, or -1.
std::vector<int> joint_map(int model, int motion) {
    std::vector<int> map(static_cast<size_t>(model), -1);
    if (model != motion && std::min(model, motion) < body_joints)
        throw ArgumentError("SmplBody",
                            "the motion is of " + std::to_string(motion) +
                                " joints, the model has " + std::to_string(model),
                            "take a motion and a model of SMPL, SMPL+H or SMPL-X");
    const int same = model == motion ? model : body_joints;
    for (int j = 0; j < same; ++j) map[static_cast<size_t>(j)] = j;
    if (model == motion || !has_fingers(model) || !has_fingers(motion)) return map;
    for (int j = 1; j <= finger_joints; ++j) map[static_cast<size_t>(model - j)] = motion - j;
    return map;
}

std::shared_ptr<const SmplModel> not_null(std::shared_ptr<const SmplModel> model) {
    if (!model) throw ArgumentError("SmplBody: model", "is null", "load one");
    return model;
}

}  // namespace

SmplBody::SmplBody(std::shared_ptr<const SmplModel> model, const AmassMotion& motion,
                   const SmplBodySettings& settings)
    : MovingSurface(settings.friction),
      m_model(not_null(std::move(model))),
      m_settings(settings),
      m_frame_time(motion.frame_time) {
    check_range("SmplBodySettings.lead_in", settings.lead_in, 0.0, 60.0);
    check_range("SmplBodySettings.friction", settings.friction, 0.0, 1.5);
    if (motion.rotations.empty())
        throw ArgumentError("SmplBody: motion", "has no frame", "load one with frames");
    m_rest = m_model->rest(
        motion.betas.head(std::min<Eigen::Index>(motion.betas.size(), m_model->shapes.cols())));
    m_joints = m_model->joints(m_rest);
    // The motion's root turned about the joint where the model has y up: AmassMotion says how.
    const Vec3 root = m_joints.row(0);
    const Eigen::Quaterniond up(Eigen::AngleAxisd(-M_PI / 2.0, Vec3::UnitX()));
    const std::vector<int> map = joint_map(m_model->joint_count(), motion.joint_count());
    for (int frame = 0; frame < motion.frame_count(); ++frame) {
        Pose pose;
        for (const int j : map)
            pose.rotations.push_back(
                j < 0 ? Eigen::Quaterniond::Identity()
                      : motion.rotations[static_cast<size_t>(frame)][static_cast<size_t>(j)]);
        pose.translation = motion.translations.row(frame).transpose() + up * root - root;
        m_frames.push_back(std::move(pose));
    }
    m_start.rotations.assign(map.size(), Eigen::Quaterniond::Identity());
    const Vec3& first = m_frames.front().translation;
    m_start.translation = {first.x(), -m_rest.col(1).minCoeff(), first.z()};
}

double SmplBody::duration() const {
    return m_settings.lead_in + m_frame_time * (static_cast<double>(m_frames.size()) - 1.0);
}

SmplBody::Pose SmplBody::pose(double time) const {
    const auto between = [](const Pose& a, const Pose& b, double s) {
        Pose pose{{}, (1.0 - s) * a.translation + s * b.translation};
        for (size_t j = 0; j < a.rotations.size(); ++j)
            pose.rotations.push_back(a.rotations[j].slerp(s, b.rotations[j]));
        return pose;
    };
    if (time < m_settings.lead_in && m_settings.lead_in > 0.0)
        return between(m_start, m_frames.front(), ease(time / m_settings.lead_in));
    const double last = static_cast<double>(m_frames.size()) - 1.0;
    const double at = std::clamp((time - m_settings.lead_in) / m_frame_time, 0.0, last);
    const auto before = static_cast<size_t>(at);
    const size_t after = std::min(before + 1, m_frames.size() - 1);
    return between(m_frames[before], m_frames[after], at - static_cast<double>(before));
}

/// From the model's pose of zero rotations to this one.
std::vector<SkinMatrix> SmplBody::matrices(const Pose& pose) const {
    std::vector<Eigen::Isometry3d> joints;
    for (size_t j = 0; j < pose.rotations.size(); ++j) {
        const Vec3 place = m_joints.row(static_cast<Eigen::Index>(j));
        const Eigen::Isometry3d turn =
            Eigen::Translation3d(place) * pose.rotations[j] * Eigen::Translation3d(-place);
        const int parent = m_model->parents[j];
        joints.push_back(parent < 0 ? Eigen::Translation3d(pose.translation) * turn
                                    : joints[static_cast<size_t>(parent)] * turn);
    }
    std::vector<SkinMatrix> matrices;
    for (const Eigen::Isometry3d& joint : joints)
        matrices.emplace_back(joint.matrix().topRows<3>());
    return matrices;
}

Points SmplBody::vertices(double time) const {
    const Pose now = pose(time);
    if (!m_settings.pose_shapes || m_model->pose_shapes.cols() == 0)
        return skin_points(m_rest, weights(), matrices(now));
    std::vector<Eigen::Matrix3d> rotations;
    for (const Eigen::Quaterniond& rotation : now.rotations)
        rotations.push_back(rotation.toRotationMatrix());
    return skin_points(m_rest + m_model->pose_offsets(rotations), weights(), matrices(now));
}

Points SmplBody::rest_vertices() const {
    return m_rest.rowwise() + m_start.translation.transpose();
}

std::vector<SkinMatrix> SmplBody::skin_matrices(double time) const {
    std::vector<SkinMatrix> result = matrices(pose(time));
    for (SkinMatrix& matrix : result)  // its points are those of rest_vertices()
        matrix.col(3) -= matrix.leftCols<3>() * m_start.translation;
    return result;
}

}  // namespace cloth
