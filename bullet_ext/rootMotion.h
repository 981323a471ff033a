#pragma once

#include "bullet_ext/bulletObstacles.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// How much of its root's motion a soft body feels: what a character that runs, turns or rides does
/// to its cloth. What it does not feel carries the cloth along, as if cloth, skin and all around it
/// were moved before each step.
class RootMotion {
 public:
    /// From the next world step on; a root that is not given anew stands still.
    /// @param duration  from `from` to `to` (s); 0: one world step
    void set(const Pose& from, const Pose& to, double duration);
    /// @param linear, angular  shares of displacement and turn that the cloth feels, 0 to 1
    void setInertia(double linear, double angular) { m_linear = linear, m_angular = angular; }

    /// Starts a world step of h seconds.
    void beginStep(double h);
    bool given() const { return m_given; }
    /// What takes the root from the start of the present world step to its end.
    Pose motion() const;
    /// What carries the cloth in a part of the time axis, counted from the start of the present
    /// world step. Nothing: the identity, bit for bit.
    Pose carry(const TimeSpan& span) const;

 private:
    Pose at(double time) const;

    Pose m_from = Pose::Identity(), m_to = Pose::Identity();
    double m_duration = 0.0;
    double m_linear = 1.0, m_angular = 1.0;
    double m_begin = 0.0, m_end = 0.0;  ///< the present world step, counted from m_from (s)
    bool m_given = false;
};

/// Moves the start of a step, of cloth and of all around it: what the step then does is inertia in
/// the frame that was carried. Ends stay where they are.
void carryStart(const Pose& motion, Boundary& boundary, ClothState& state);

}  // namespace cloth
