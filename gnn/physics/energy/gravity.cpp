#include "gnn/physics/energy/gravity.h"

namespace cloth {

void GravityEnergy::begin_step(const Vec3& gravity, const Points& external) {
    m_forces.resize(m_garment->vertex_count(), 3);
    m_forces.rowwise() = gravity.transpose();
    if (external.rows() > 0) m_forces += external;
    m_forces.array().colwise() *= m_garment->masses().array();
}

double GravityEnergy::value(const Points& x) const {
    return -m_forces.cwiseProduct(x).sum();
}

double GravityEnergy::add_gradient(const Points& x, Points& gradient) const {
    gradient -= m_forces;
    return value(x);
}

}  // namespace cloth
