#include "gnn/physics/energy/inertia.h"

namespace cloth {

void InertiaEnergy::begin_step(const ClothState& state, double dt, const InertialStep* step) {
    m_stiffness = m_garment->masses() / (dt * dt);
    if (!step) {
        m_target = state.x + dt * state.v;
        return;
    }
    m_target = step->target;
    m_stiffness.array() *= step->weight.array();
}

double InertiaEnergy::value(const Points& x) const {
    double energy = 0.0;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        energy += 0.5 * m_stiffness[i] * (x.row(i) - m_target.row(i)).squaredNorm();
    return energy;
}

double InertiaEnergy::add_gradient(const Points& x, Points& gradient) const {
    double energy = 0.0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Vec3 offset = (x.row(i) - m_target.row(i)).transpose();
        gradient.row(i) += m_stiffness[i] * offset.transpose();
        energy += 0.5 * m_stiffness[i] * offset.squaredNorm();
    }
    return energy;
}

void InertiaEnergy::add_hessian(const BlockPattern& pattern, double* values) const {
    for (Eigen::Index i = 0; i < m_stiffness.size(); ++i)
        add_block(values, pattern.diagonal(i), m_stiffness[i] * Eigen::Matrix3d::Identity());
}

}  // namespace cloth
