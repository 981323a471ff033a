#include "bullet_ext/bodyGoals.h"

#include <cmath>
#include <utility>

namespace cloth {

void BodyGoals::set(SkinGoals goals, double duration) {
    m_goals = std::move(goals);
    if (m_goals.normal0.rows() == 0) m_goals.normal0.setZero(m_goals.x0.rows(), 3);
    if (m_goals.normal1.rows() == 0) m_goals.normal1.setZero(m_goals.x0.rows(), 3);
    m_duration = duration;
    m_begin = m_end = 0.0;
    m_given = true;
}

void BodyGoals::move(const Pose& motion) {
    const Points now = this->now();
    const auto turned = [&](const Points& v) { return Points(v * motion.linear().transpose()); };
    m_goals.x0 = turned(now).rowwise() + motion.translation().transpose();
    m_goals.x1 = m_goals.x0;
    m_goals.normal0 = m_goals.normal1 = turned(m_goals.normal1);
    m_duration = 0.0;
}

void BodyGoals::beginStep(double h) {
    if (m_given && m_duration == 0.0) m_duration = h;
    m_begin = m_end;
    m_end += h;
}

SkinGoals BodyGoals::during(const TimeSpan& span) const {
    const double begin = m_begin + span.begin, end = begin + span.length;
    const auto both = [&](const Points& from, const Points& to, Points& first, Points& last) {
        first = at(from, to, begin);
        last = at(from, to, end);
    };
    SkinGoals goals;
    both(m_goals.x0, m_goals.x1, goals.x0, goals.x1);
    both(m_goals.normal0, m_goals.normal1, goals.normal0, goals.normal1);
    return goals;
}

/// Goals that were not given anew stand still; those that were are assumed to go on as they do, as
/// animated meshes are.
Points BodyGoals::at(const Points& from, const Points& to, double time) const {
    const bool stands = m_begin >= 0.999 * m_duration;
    const double s = stands ? 1.0 : time / m_duration;
    if (s == 0.0) return from;
    if (std::abs(s - 1.0) < 1e-6) return to;
    return from + s * (to - from);
}

}  // namespace cloth
