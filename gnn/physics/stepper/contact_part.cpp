#include "gnn/physics/stepper/contact_part.h"

namespace cloth {
namespace {

/// Unit vector on the way from one to another; the farther end's where they are opposite.
Vec3 between(const Vec3& from, const Vec3& to, double s) {
    const Vec3 sum = (1.0 - s) * from + s * to;
    const double length = sum.norm();
    return length > 1e-6 ? Vec3(sum / length) : to;
}

}  // namespace

void ContactPart::begin(const SurfaceContacts& contacts, int count) {
    m_whole = &contacts;
    m_count = count;
    m_part = contacts;
}

const SurfaceContacts& ContactPart::take(int k, const Points& x) {
    const double s0 = static_cast<double>(k) / m_count;
    const double s1 = static_cast<double>(k + 1) / m_count;
    const bool first = k == 0, last = k + 1 == m_count;
    const Eigen::Index count = static_cast<Eigen::Index>(m_whole->obstacle.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!m_whole->has(i)) continue;
        const Eigen::RowVector3d from = m_whole->point0.row(i), to = m_whole->point1.row(i);
        const Vec3 normal0 = m_whole->normal0.row(i), normal1 = m_whole->normal1.row(i);
        if (first) {
            m_part.point0.row(i) = from;
            m_part.normal0.row(i) = normal0;
            m_part.distance[i] = m_whole->distance[i];
        } else {  // where the part before ended
            m_part.point0.row(i) = m_part.point1.row(i);
            m_part.normal0.row(i) = m_part.normal1.row(i);
            m_part.distance[i] = m_part.normal0.row(i).dot(x.row(i) - m_part.point0.row(i));
        }
        m_part.point1.row(i) = last ? to : Eigen::RowVector3d((1.0 - s1) * from + s1 * to);
        m_part.normal1.row(i) = last ? normal1 : between(normal0, normal1, s1);
    }
    for (size_t r = 0; r < m_whole->ridges.size(); ++r) {
        const RidgeContact& whole = m_whole->ridges[r];
        RidgeContact& part = m_part.ridges[r];
        part.normal0 = between(whole.normal0, whole.normal, s0);
        part.point0 = (1.0 - s0) * whole.point0 + s0 * whole.point1;
        part.normal = last ? whole.normal : between(whole.normal0, whole.normal, s1);
        part.point1 = (1.0 - s1) * whole.point0 + s1 * whole.point1;
        part.height = last ? whole.height : part.normal.dot(part.point1);
    }
    return m_part;
}

}  // namespace cloth
