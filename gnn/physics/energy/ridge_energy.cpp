#include "gnn/physics/energy/ridge_energy.h"

#include <algorithm>

namespace cloth {

RidgeEnergy::Law RidgeEnergy::law(double depth, double weight) {
    constexpr double cubic_depth = 2e-4;  // m
    if (depth <= 0.0) return {0.0, 0.0, 0.0};
    const double d = std::min(depth, cubic_depth), more = depth - d;
    const double force = 3.0 * weight * d * d, stiffness = 6.0 * weight * d;
    return {weight * d * d * d + force * more + 0.5 * stiffness * more * more,
            force + stiffness * more, stiffness};
}

void RidgeEnergy::begin_step(const SurfaceContacts& contacts, double distance) {
    m_planes.clear();
    if (!(distance > 0.0)) return;
    const Faces& faces = m_garment->rest().faces;
    for (const RidgeContact& ridge : contacts.ridges)
        m_planes.push_back({ridge.face,
                            {faces(ridge.face, 0), faces(ridge.face, 1), faces(ridge.face, 2)},
                            ridge.weight,
                            ridge.normal,
                            ridge.height + distance});
}

double RidgeEnergy::value(const Points& x, double weight) const {
    double energy = 0.0;
    for (const Plane& plane : m_planes) energy += law(plane.depth(x), weight).energy;
    return energy;
}

double RidgeEnergy::add_gradient(const Points& x, double weight, Points& gradient) const {
    double energy = 0.0;
    for (const Plane& plane : m_planes) {
        const Law at = law(plane.depth(x), weight);
        if (at.energy == 0.0) continue;
        const Vec3 force = at.force * plane.normal;
        for (size_t k = 0; k < 3; ++k)
            gradient.row(plane.vertex[k]) -= plane.weight[k] * force.transpose();
        energy += at.energy;
    }
    return energy;
}

void RidgeEnergy::add_hessian(const Points& x, double weight, const BlockPattern& pattern,
                              double* values) const {
    for (const Plane& plane : m_planes) {
        const double stiffness = law(plane.depth(x), weight).stiffness;
        if (stiffness == 0.0) continue;
        const Eigen::Matrix3d block = stiffness * plane.normal * plane.normal.transpose();
        const auto& slots = pattern.face(static_cast<size_t>(plane.face));
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j)
                if (plane.weight[i] * plane.weight[j] != 0.0)
                    add_block(values, slots[3 * i + j], plane.weight[i] * plane.weight[j] * block);
    }
}

}  // namespace cloth
