#pragma once

#include "bullet_ext/bulletObstacles.h"
#include "data/core/skin_goals.h"

namespace cloth {

/// Skinned goals of one soft body over the time of its world: as animated meshes, they are given
/// now and for the end of some time, and stand still when they were not given anew.
class BodyGoals {
 public:
    /// Goals that rest where nodes are (|V| x 3, m), without normals.
    explicit BodyGoals(const Points& x) : m_goals(SkinGoals::at(x, Points::Zero(x.rows(), 3))) {}

    /// From the next world step on.
    /// @param goals     all of one size, finite; without normals no vertex has a backstop
    /// @param duration  from x0 to x1 (s); 0: one world step
    void set(SkinGoals goals, double duration);
    Eigen::Index size() const { return m_goals.x0.rows(); }
    /// Whether they ever were.
    bool given() const { return m_given; }

    /// Puts them elsewhere at once.
    void move(const Pose& motion);
    /// Starts a world step of h seconds.
    void beginStep(double h);
    /// Goals in a part of the time axis, counted from the start of the present world step.
    SkinGoals during(const TimeSpan& span) const;
    /// Where they are at the end of the present world step (|V| x 3, m).
    Points now() const { return at(m_goals.x0, m_goals.x1, m_end); }

 private:
    Points at(const Points& from, const Points& to, double time) const;

    SkinGoals m_goals;
    double m_duration = 0.0;
    double m_begin = 0.0, m_end = 0.0;  ///< the present world step, counted from x0 (s)
    bool m_given = false;
};

}  // namespace cloth
