#pragma once

#include "collision/proximity/proximity.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// backward_euler: of first order, damps motion by its error; what networks are trained on.
/// bdf2: of second order, twice as near to the fine solution when it is converged; needs the last
/// two states, which the stepper keeps.
enum class Integrator { backward_euler, bdf2 };

/// Inertia of one step: E = sum weight_i m_i / (2 dt^2) |x_i - target_i|^2.
struct InertialStep {
    Points target;   ///< |V| x 3 (m): where each vertex would be at t + dt if no force acted
    VectorX weight;  ///< |V|: 1 of backward Euler, 9/4 of BDF2
    double dt;       ///< of the matrix of most vertices: 2/3 of the step (s)
};

/// InertialStep::dt of a BDF2 step (s).
inline double bdf2_inertial_dt(double dt) {
    return dt / 1.5;
}

/// The time integration of a stepper.
///
/// BDF2 (Hairer and Wanner, Solving Ordinary Differential Equations II, chapter III.1), from the
/// states at t and t - dt:
///
///     target = (4 x_t - x_{t-1}) / 3 + dt (8 u_t - 2 u_{t-1}) / 9,   weight 9/4
///     u_{t+1} = (3 x_{t+1} - 4 x_t + x_{t-1}) / (2 dt)
///
/// u are velocities of second order, which stay in here; ClothState's are the motion over dt.
///
/// Vertices in contact take backward Euler: a history from before an impact would throw them back.
/// So do all vertices in the first step, after a change of the time step, and in a step whose state
/// is not the one that the last step returned, bit for bit.
class TimeIntegration {
 public:
    explicit TimeIntegration(Integrator kind) : m_kind(kind) {}

    /// Null: backward Euler for all vertices.
    /// @param contacts  at t, or empty; vertices closer than `contact_distance` (m) are in contact
    const InertialStep* begin_step(const ClothState& state, const SurfaceContacts& contacts,
                                   double contact_distance, double dt);

    /// Remembers an accepted step to `x` and `v`.
    void end_step(const ClothState& before, const Points& x, const Points& v, double dt);

 private:
    bool continues(const ClothState& state, double dt) const;

    Integrator m_kind;
    bool m_active = false;  ///< BDF2 is at work in this step
    double m_dt = 0.0;      ///< of the last step (s)
    Points m_x, m_v;        ///< that the last step returned
    Points m_x_before;      ///< positions one step earlier
    Points m_u, m_u_before;
    InertialStep m_step;
};

}  // namespace cloth
