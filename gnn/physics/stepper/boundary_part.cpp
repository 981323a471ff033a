#include "gnn/physics/stepper/boundary_part.h"

#include "data/core/pose.h"

namespace cloth {
namespace {

/// The part [s0, s1] of an obstacle's motion.
void cut(const Obstacle& whole, double s0, double s1, Obstacle& part) {
    const auto vertices = [&](double s, Points& x) {
        if (s <= 0.0)
            x = whole.x0;
        else if (s >= 1.0)
            x = whole.x1;
        else
            x = (1.0 - s) * whole.x0 + s * whole.x1;
    };
    part.shape = whole.shape;
    part.faces = whole.faces;
    part.limbs = whole.limbs;
    part.id = whole.id;
    part.is_whole = whole.is_whole;
    part.solid = whole.solid;
    part.half_extents = whole.half_extents;
    part.radius = whole.radius;
    part.friction = whole.friction;
    if (whole.shape == ObstacleShape::mesh && whole.x0.rows() == whole.x1.rows()) {
        vertices(s0, part.x0);
        vertices(s1, part.x1);
    }
    part.pose0 = interpolate(whole.pose0, whole.pose1, s0);
    part.pose1 = interpolate(whole.pose0, whole.pose1, s1);
}

/// The part [s0, s1] of the way of goals, of which the ends stay as they are.
void cut(const SkinGoals& whole, double s0, double s1, SkinGoals& part) {
    const auto between = [](const Points& from, const Points& to, double s, Points& x) {
        if (s <= 0.0)
            x = from;
        else if (s >= 1.0)
            x = to;
        else
            x = (1.0 - s) * from + s * to;
    };
    between(whole.x0, whole.x1, s0, part.x0);
    between(whole.x0, whole.x1, s1, part.x1);
    if (whole.normal0.rows() != whole.normal1.rows()) return;
    between(whole.normal0, whole.normal1, s0, part.normal0);
    between(whole.normal0, whole.normal1, s1, part.normal1);
}

}  // namespace

void BoundaryPart::begin(const Garment& garment, const ClothState& state, const Boundary& boundary,
                         int count, Surfaces surfaces) {
    m_whole = &boundary;
    m_count = count;
    m_surfaces = surfaces;
    m_has_goals = garment.has_goals();
    m_part.gravity = boundary.gravity;
    m_part.accelerations = boundary.accelerations;
    m_part.ignored_limbs = boundary.ignored_limbs;
    m_part.pinched = boundary.pinched;
    m_part.overlapped = boundary.overlapped;
    m_part.obstacles.resize(boundary.obstacles.size());
    m_pins_before.resize(boundary.pin_targets.rows(), 3);
    for (size_t p = 0; p < garment.pins().size(); ++p)
        m_pins_before.row(static_cast<Eigen::Index>(p)) = state.x.row(garment.pins()[p]);
}

const Boundary& BoundaryPart::take(int k) {
    const double s0 = static_cast<double>(k) / m_count;
    const double s1 = static_cast<double>(k + 1) / m_count;
    for (size_t i = 0; i < m_part.obstacles.size(); ++i)
        if (m_surfaces == Surfaces::moved)
            cut(m_whole->obstacles[i], s0, s1, m_part.obstacles[i]);
        else
            m_part.obstacles[i].friction = m_whole->obstacles[i].friction;
    if (m_has_goals) cut(m_whole->goals, s0, s1, m_part.goals);
    m_part.pin_targets = k + 1 == m_count
                             ? m_whole->pin_targets
                             : Points((1.0 - s1) * m_pins_before + s1 * m_whole->pin_targets);
    return m_part;
}

}  // namespace cloth
