#include "collision/self/rigid_impact_zones.h"

#include <algorithm>

namespace cloth {

RigidImpactZones::RigidImpactZones(const Garment& garment, const VectorX& masses)
    : m_masses(masses.size() > 0 ? masses : garment.masses()),
      m_pinned(garment.is_pinned()),
      m_parent(static_cast<size_t>(garment.vertex_count()), -1) {
}

void RigidImpactZones::begin(const Points& x) {
    m_free_x = x;
    std::fill(m_parent.begin(), m_parent.end(), -1);
    m_members.clear();
}

int RigidImpactZones::root(int vertex) {
    while (m_parent[static_cast<size_t>(vertex)] != vertex) {
        int& above = m_parent[static_cast<size_t>(vertex)];
        above = m_parent[static_cast<size_t>(above)];
        vertex = above;
    }
    return vertex;
}

void RigidImpactZones::merge(const std::vector<SelfPair>& pairs) {
    for (const SelfPair& pair : pairs)
        for (const int v : pair.elements.vertex) {
            int& parent = m_parent[static_cast<size_t>(v)];
            if (parent < 0) {
                parent = v;
                m_members.push_back(v);
            }
            const int a = root(v), b = root(pair.elements.vertex[0]);
            m_parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
        }
}

void RigidImpactZones::apply(const Points& x0, bool turning, Points& x) {
    std::sort(m_members.begin(), m_members.end(), [&](int a, int b) {
        const int zone = root(a), other = root(b);
        return zone != other ? zone < other : a < b;
    });
    const int *first = m_members.data(), *end = first + m_members.size();
    while (first != end) {
        const int zone = root(*first);
        const int* last = first;
        while (last != end && root(*last) == zone) ++last;
        move(first, last, x0, turning, x);
        first = last;
    }
}

void RigidImpactZones::move(const int* first, const int* last, const Points& x0, bool turning,
                            Points& x) const {
    if (std::any_of(first, last, [&](int v) { return m_pinned[static_cast<size_t>(v)]; }))
        return follow_pins(first, last, x0, x);
    double mass = 0.0;
    Vec3 centre = Vec3::Zero(), shift = Vec3::Zero(), momentum = Vec3::Zero();
    for (const int* v = first; v != last; ++v) {
        mass += m_masses[*v];
        centre += m_masses[*v] * x0.row(*v).transpose();
        shift += m_masses[*v] * (m_free_x.row(*v) - x0.row(*v)).transpose();
    }
    centre /= mass;
    shift /= mass;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (const int* v = first; v != last; ++v) {
        const Vec3 arm = x0.row(*v).transpose() - centre;
        momentum += m_masses[*v] * arm.cross((m_free_x.row(*v) - x0.row(*v)).transpose());
        inertia += m_masses[*v] *
                   (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    // A little more, so that vertices in a line, which have none about it, turn about it not at
    // all.
    inertia.diagonal().array() += 1e-9 * inertia.trace() + 1e-300;
    const Vec3 turn = inertia.inverse() * momentum;
    const double angle = turn.norm();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    // Half a turn or more cannot be told from the other way round, and points would meet on it.
    if (turning && angle > 0.0 && angle < 2.0) rotation = Eigen::AngleAxisd(angle, turn / angle);
    for (const int* v = first; v != last; ++v)
        x.row(*v) = (centre + shift + rotation * (x0.row(*v).transpose() - centre)).transpose();
}

void RigidImpactZones::follow_pins(const int* first, const int* last, const Points& x0,
                                   Points& x) const {
    Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();
    int pins = 0;
    for (const int* v = first; v != last; ++v)
        if (m_pinned[static_cast<size_t>(*v)]) {
            shift += m_free_x.row(*v) - x0.row(*v);
            ++pins;
        }
    for (const int* v = first; v != last; ++v)
        if (!m_pinned[static_cast<size_t>(*v)]) x.row(*v) = x0.row(*v) + shift / pins;
}

}  // namespace cloth
