#include "gnn/physics/energy/time_integration.h"

namespace cloth {
namespace {

constexpr double bdf2_weight = 2.25;

}  // namespace

bool TimeIntegration::continues(const ClothState& state, double dt) const {
    return m_kind == Integrator::bdf2 && dt == m_dt && same_points(state.x, m_x) &&
           same_points(state.v, m_v);
}

const InertialStep* TimeIntegration::begin_step(const ClothState& state,
                                                const SurfaceContacts& contacts,
                                                double contact_distance, double dt) {
    m_active = continues(state, dt);
    if (!m_active) return nullptr;
    m_step.dt = bdf2_inertial_dt(dt);
    m_step.target =
        (4.0 * state.x - m_x_before) / 3.0 + (dt / 9.0) * (8.0 * m_u - 2.0 * m_u_before);
    m_step.weight.setConstant(state.x.rows(), bdf2_weight);
    for (size_t k = 0; k < contacts.obstacle.size(); ++k) {
        const Eigen::Index i = static_cast<Eigen::Index>(k);
        if (!contacts.has(i) || contacts.distance[i] > 1.5 * contact_distance) continue;
        m_step.weight[i] = 1.0;
        m_step.target.row(i) = state.x.row(i) + dt * state.v.row(i);
    }
    return &m_step;
}

void TimeIntegration::end_step(const ClothState& before, const Points& x, const Points& v,
                               double dt) {
    if (m_kind == Integrator::backward_euler) return;
    m_u_before = m_active ? m_u : before.v;
    m_u = v;
    for (Eigen::Index i = 0; m_active && i < x.rows(); ++i)
        if (m_step.weight[i] == bdf2_weight)
            m_u.row(i) = (3.0 * x.row(i) - 4.0 * before.x.row(i) + m_x_before.row(i)) / (2.0 * dt);
    m_x_before = before.x;
    m_x = x;
    m_v = v;
    m_dt = dt;
}

}  // namespace cloth
