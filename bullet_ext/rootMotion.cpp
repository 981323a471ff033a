#include "bullet_ext/rootMotion.h"

namespace cloth {

void RootMotion::set(const Pose& from, const Pose& to, double duration) {
    m_from = from;
    m_to = to;
    m_duration = duration;
    m_begin = m_end = 0.0;
    m_given = true;
}

void RootMotion::beginStep(double h) {
    if (m_given && m_duration == 0.0) m_duration = h;
    m_begin = m_end;
    m_end += h;
}

Pose RootMotion::at(double time) const {
    const bool stands = m_begin >= 0.999 * m_duration;
    return stands ? m_to : interpolate(m_from, m_to, time / m_duration);
}

Pose RootMotion::motion() const {
    return at(m_end) * at(m_begin).inverse();
}

Pose RootMotion::carry(const TimeSpan& span) const {
    if (m_linear == 1.0 && m_angular == 1.0) return Pose::Identity();
    const Pose from = at(m_begin + span.begin), to = at(m_begin + span.begin + span.length);
    if (from.matrix() == to.matrix()) return Pose::Identity();
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
    const Vec3 way = to.translation() - from.translation();
    Pose carry = Pose::Identity();
    carry.translate(from.translation() + (1.0 - m_linear) * way);
    carry.rotate(Eigen::AngleAxisd((1.0 - m_angular) * turn.angle(), turn.axis()));
    carry.translate(-from.translation());
    return carry;
}

void carryStart(const Pose& motion, Boundary& boundary, ClothState& state) {
    const auto turn = [&](Points& v) {
        if (v.rows() > 0) v = Points(v * motion.linear().transpose());
    };
    state.x = transformed(state.x, motion);
    turn(state.v);
    for (Obstacle& obstacle : boundary.obstacles) {
        if (obstacle.x0.rows() > 0) obstacle.x0 = transformed(obstacle.x0, motion);
        obstacle.pose0 = motion * obstacle.pose0;
    }
    if (boundary.goals.x0.rows() > 0) boundary.goals.x0 = transformed(boundary.goals.x0, motion);
    turn(boundary.goals.normal0);
    boundary.trees = nullptr;  // poses that no other cloth meets
}

}  // namespace cloth
