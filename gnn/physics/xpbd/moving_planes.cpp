#include "gnn/physics/xpbd/moving_planes.h"

#include <algorithm>
#include <cmath>

#include "collision/proximity/direction.h"

namespace cloth {

void MovingPlanes::begin_step(const Garment& garment, const Points& x, const Boundary& boundary,
                              const SurfaceContacts& contacts, double distance, int substeps) {
    m_planes.clear();
    m_too_close.clear();
    m_distance = distance;
    m_length = 1.0 / substeps;
    const Eigen::Index count = static_cast<Eigen::Index>(contacts.obstacle.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        const size_t k = static_cast<size_t>(i);
        if (!contacts.has(i) || garment.is_pinned()[k]) continue;
        const size_t obstacle = static_cast<size_t>(contacts.obstacle[k]);
        add_plane(i, x, contacts, boundary.obstacles[obstacle].friction);
    }
}

void MovingPlanes::add_plane(Eigen::Index i, const Points& x, const SurfaceContacts& contacts,
                             double friction) {
    Plane plane;
    plane.vertex = i;
    plane.point = contacts.point0.row(i);
    plane.point_move = contacts.point1.row(i) - contacts.point0.row(i);
    plane.normal = direction_at_start(contacts, i, x);
    plane.normal_move =
        turned(plane.normal, contacts.normal0.row(i), contacts.normal1.row(i)) - plane.normal;
    plane.turns = turns(contacts.normal0.row(i), contacts.normal1.row(i));
    plane.friction = friction;
    plane.deficit = std::max(0.0, m_distance - contacts.distance[i]);
    if (plane.deficit > 0.0) m_too_close.push_back(m_planes.size());
    m_planes.push_back(plane);
}

void MovingPlanes::begin_substep(int substep) {
    m_progress = substep * m_length;
}

void MovingPlanes::recover(PaddedPoints& x) const {
    const double before = m_progress - m_length;
    for (const size_t k : m_too_close) {
        const Plane& plane = m_planes[k];
        auto at = x.row(plane.vertex).head<3>();
        const Vec3 normal = (plane.normal + before * plane.normal_move).normalized();
        const Vec3 point = plane.point + before * plane.point_move;
        const double required = m_distance - (1.0 - m_progress) * plane.deficit;
        const double missing = required - normal.dot(at.transpose() - point);
        const double most = m_length * plane.deficit;
        if (missing > 0.0) at += std::min(missing, most) * normal.transpose();
    }
}

void MovingPlanes::project(const PaddedPoints& before, PaddedPoints& x) const {
    for (const Plane& plane : m_planes) {
        const Vec3 at = x.row(plane.vertex).head<3>();
        const Vec3 direction = plane.normal + m_progress * plane.normal_move;
        const double scaled = direction.dot(at - plane.point - m_progress * plane.point_move);
        if (scaled >= m_distance) continue;  // `direction` is no longer than 1
        const double scale = 1.0 / direction.norm();
        const double required = m_distance - (1.0 - m_progress) * plane.deficit;
        const double push = required - scale * scaled;
        if (!(push > 0.0)) continue;
        const Vec3 normal = scale * direction;
        const Vec3 pushed = at + push * normal;
        const Vec3 start = before.row(plane.vertex).head<3>();
        Vec3 move = pushed - start - m_length * plane.point_move;
        if (plane.turns) move -= m_length * required * plane.normal_move;  // stands at that height
        const Vec3 slip = move - normal.dot(move) * normal;
        const double length = slip.norm(), limit = plane.friction * push;
        const double taken = length > limit ? limit / length : 1.0;
        x.row(plane.vertex).head<3>() = pushed - taken * slip;
    }
}

}  // namespace cloth
