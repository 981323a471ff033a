#include "data/body/animated_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "data/body/ease.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

using Eigen::Quaterniond;

namespace {

Vec3 log_rotation(Quaterniond q) {
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    const double sine = q.vec().norm();
    return sine < 1e-12 ? Vec3(2.0 * q.vec())
                        : Vec3(2.0 * std::atan2(sine, q.w()) / sine * q.vec());
}

Quaterniond exp_rotation(const Vec3& v) {
    const double angle = v.norm();
    if (angle < 1e-12) return Quaterniond::Identity();
    return Quaterniond(Eigen::AngleAxisd(angle, v / angle));
}

/// Inner control rotation of key i (Shoemake 1987): with it, neighbouring arcs share a tangent.
Quaterniond inner_control(const Quaterniond& before, const Quaterniond& key,
                          const Quaterniond& after) {
    const Vec3 sum = log_rotation(key.conjugate() * before) + log_rotation(key.conjugate() * after);
    return key * exp_rotation(-0.25 * sum);
}

/// Spherical quadrangle interpolation (Shoemake 1987) from a (s = 0) to b (s = 1).
Quaterniond squad(const Quaterniond& a, const Quaterniond& a_control, const Quaterniond& b_control,
                  const Quaterniond& b, double s) {
    return a.slerp(s, b).slerp(2.0 * s * (1.0 - s), a_control.slerp(s, b_control));
}

/// Cubic through b (s = 0) and c (s = 1) with central differences as tangents (Catmull-Rom).
Vec3 catmull_rom(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double s) {
    return b +
           0.5 * s * (c - a + s * (2.0 * a - 5.0 * b + 4.0 * c - d + s * (3.0 * (b - c) + d - a)));
}

BodyPose blend(const BodyPose& a, const BodyPose& b, double s) {
    BodyPose pose{(1.0 - s) * a.root_position + s * b.root_position, {}};
    for (size_t j = 0; j < a.rotations.size(); ++j)
        pose.rotations.push_back(a.rotations[j].slerp(s, b.rotations[j]));
    return pose;
}

void validate(const Motion& motion, const AnimationSettings& settings) {
    if (motion.frames.empty())
        throw ArgumentError("motion " + motion.name, "has no frames", "load one with frames");
    check_range("AnimationSettings.lead_in", settings.lead_in, 0.0, 60.0);
    check_range("AnimationSettings.start_ramp", settings.start_ramp, 0.0, 10.0);
    check_range("AnimationSettings.friction", settings.friction, 0.0, 1.5);
}

}  // namespace

AnimatedBody::AnimatedBody(std::shared_ptr<const Body> body, const Motion& motion,
                           const AnimationSettings& settings)
    : MovingSurface(settings.friction),
      m_body(std::move(body)),
      m_settings(settings),
      m_frame_time(motion.frame_time) {
    validate(motion, settings);
    m_keys = retarget(*m_body, motion, settings.retarget);
    const int last = static_cast<int>(m_keys.size()) - 1;
    for (int k = 0; k <= last; ++k) {
        const BodyPose& before = m_keys[std::max(k - 1, 0)];
        const BodyPose& after = m_keys[std::min(k + 1, last)];
        std::vector<Quaterniond> controls;
        for (size_t j = 0; j < m_keys[k].rotations.size(); ++j)
            controls.push_back(
                inner_control(before.rotations[j], m_keys[k].rotations[j], after.rotations[j]));
        m_tangents.push_back(std::move(controls));
    }
}

double AnimatedBody::duration() const {
    const double motion_time = m_frame_time * (static_cast<double>(m_keys.size()) - 1.0);
    return m_settings.lead_in + 0.5 * m_settings.start_ramp + motion_time;
}

BodyPose AnimatedBody::motion_pose(double motion_time) const {
    const int last = static_cast<int>(m_keys.size()) - 1;
    const double at = std::clamp(motion_time / m_frame_time, 0.0, static_cast<double>(last));
    const int k = std::min(static_cast<int>(at), std::max(last - 1, 0));
    const int next = std::min(k + 1, last);
    const double s = at - k;
    const auto root = [&](int i) { return m_keys[std::clamp(i, 0, last)].root_position; };
    BodyPose pose{catmull_rom(root(k - 1), root(k), root(next), root(k + 2), s), {}};
    for (size_t j = 0; j < m_keys[k].rotations.size(); ++j)
        pose.rotations.push_back(squad(m_keys[k].rotations[j], m_tangents[k][j],
                                       m_tangents[next][j], m_keys[next].rotations[j], s)
                                     .normalized());
    return pose;
}

BodyPose AnimatedBody::pose(double time) const {
    if (time < m_settings.lead_in)
        return blend(rest_pose(*m_body), m_keys.front(), ease(time / m_settings.lead_in));
    // Constant acceleration of the motion's own clock up to full speed.
    const double running = time - m_settings.lead_in;
    const double ramp = m_settings.start_ramp;
    return motion_pose(running < ramp ? 0.5 * running * running / ramp : running - 0.5 * ramp);
}

JointTransforms AnimatedBody::joint_transforms(double time) const {
    return cloth::joint_transforms(*m_body, pose(time));
}

std::vector<SkinMatrix> AnimatedBody::skin_matrices(double time) const {
    std::vector<SkinMatrix> matrices;
    for (const Eigen::Isometry3d& transform : joint_transforms(time))
        matrices.emplace_back(transform.matrix().topRows<3>());
    return matrices;
}

Points AnimatedBody::vertices(double time) const {
    return m_body->skin(joint_transforms(time));
}

}  // namespace cloth
