#include "gnn/physics/energy/contact.h"

namespace cloth {

void ContactEnergy::begin_step(const SurfaceContacts& contacts, double distance) {
    m_planes.clear();
    const Eigen::Index count = static_cast<Eigen::Index>(contacts.obstacle.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!contacts.has(i)) continue;
        const Vec3 normal = contacts.normal1.row(i);
        const double height = normal.dot(contacts.point1.row(i).transpose());
        m_planes.push_back({i, normal, height + distance});
    }
}

double ContactEnergy::value(const Points& x, double weight) const {
    double energy = 0.0;
    for (const Plane& plane : m_planes) {
        const double depth = plane.offset - plane.normal.dot(x.row(plane.vertex).transpose());
        if (depth > 0.0) energy += weight * depth * depth * depth;
    }
    return energy;
}

double ContactEnergy::add_gradient(const Points& x, double weight, Points& gradient) const {
    double energy = 0.0;
    for (const Plane& plane : m_planes) {
        const double depth = plane.offset - plane.normal.dot(x.row(plane.vertex).transpose());
        if (depth <= 0.0) continue;
        gradient.row(plane.vertex) -= (3.0 * weight * depth * depth) * plane.normal.transpose();
        energy += weight * depth * depth * depth;
    }
    return energy;
}

void ContactEnergy::add_hessian(const Points& x, double weight, const BlockPattern& pattern,
                                double* values) const {
    for (const Plane& plane : m_planes) {
        const double depth = plane.offset - plane.normal.dot(x.row(plane.vertex).transpose());
        if (depth > 0.0)
            add_block(values, pattern.diagonal(plane.vertex),
                      6.0 * weight * depth * plane.normal * plane.normal.transpose());
    }
}

}  // namespace cloth
