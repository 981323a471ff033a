#include "gnn/physics/energy/goal_energy.h"

#include <algorithm>

namespace cloth {
namespace {

/// A limit at one place: how far x is beyond it, and the way there.
struct Beyond {
    double depth;  ///< (m), 0: within
    Vec3 way;      ///< unit direction in which the depth grows
};

Beyond beyond_distance(const VertexGoal& goal, const Vec3& x) {
    const Vec3 away = x - goal.place;
    const double length = away.norm(), depth = length - goal.max_distance;
    if (!(depth > 0.0)) return {0.0, Vec3::Zero()};
    return {depth, away / length};
}

Beyond behind_backstop(const VertexGoal& goal, const Vec3& x) {
    if (goal.normal.isZero(0.0)) return {0.0, Vec3::Zero()};
    return {std::max(0.0, -goal.backstop - (x - goal.place).dot(goal.normal)), -goal.normal};
}

double energy_of(const GoalEnergy::Drive& drive, const Vec3& x) {
    return 0.5 * drive.stiffness * (x - drive.place).squaredNorm() +
           0.5 * drive.damping * (x - drive.carried).squaredNorm();
}

}  // namespace

void GoalEnergy::begin_step(const ClothState& state, const SkinGoals& goals, double dt,
                            double stiffness) {
    m_drives.clear();
    m_limits.clear();
    if (!m_garment->has_goals()) return;
    m_stiffness = stiffness * m_garment->fabric().longitudinal();
    take_goals(m_garment->goal_limits(), goals, m_garment->is_pinned(), 1.0, m_limits);
    take_drives(state, goals, dt);
}

void GoalEnergy::take_drives(const ClothState& state, const SkinGoals& goals, double dt) {
    const GoalLimits& limits = m_garment->goal_limits();
    for (Eigen::Index i = 0; i < m_garment->vertex_count(); ++i) {
        if (m_garment->is_pinned()[static_cast<size_t>(i)]) continue;
        const double mass = m_garment->masses()[i];
        Drive drive;
        drive.stiffness =
            limits.drive_stiffness.size() > 0 ? mass * limits.drive_stiffness[i] : 0.0;
        drive.damping = limits.drive_damping.size() > 0 ? mass * limits.drive_damping[i] / dt : 0.0;
        if (drive.total() == 0.0) continue;
        drive.vertex = static_cast<int>(i);
        drive.place = goals.x1.row(i);
        drive.carried = state.x.row(i) + goals.x1.row(i) - goals.x0.row(i);
        m_drives.push_back(drive);
    }
}

double GoalEnergy::value(const Points& x) const {
    double energy = 0.0;
    for (const VertexGoal& goal : m_limits) {
        const Vec3 at = x.row(goal.vertex);
        const double far = beyond_distance(goal, at).depth,
                     behind = behind_backstop(goal, at).depth;
        energy += 0.5 * m_stiffness * (far * far + behind * behind);
    }
    for (const Drive& drive : m_drives) energy += energy_of(drive, x.row(drive.vertex));
    return energy;
}

double GoalEnergy::add_gradient(const Points& x, Points& gradient) const {
    double energy = 0.0;
    for (const VertexGoal& goal : m_limits) {
        const Vec3 at = x.row(goal.vertex);
        for (const Beyond& beyond : {beyond_distance(goal, at), behind_backstop(goal, at)}) {
            if (beyond.depth == 0.0) continue;
            gradient.row(goal.vertex) += m_stiffness * beyond.depth * beyond.way.transpose();
            energy += 0.5 * m_stiffness * beyond.depth * beyond.depth;
        }
    }
    for (const Drive& drive : m_drives) {
        const Vec3 at = x.row(drive.vertex);
        const Vec3 force =
            drive.stiffness * (at - drive.place) + drive.damping * (at - drive.carried);
        gradient.row(drive.vertex) += force.transpose();
        energy += energy_of(drive, at);
    }
    return energy;
}

Eigen::Matrix3d GoalEnergy::block(const VertexGoal& goal, double stiffness, const Vec3& x) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    const Beyond far = beyond_distance(goal, x);
    if (far.depth > 0.0) {
        // Across the way the pull turns with the vertex.
        const double across = far.depth / (far.depth + goal.max_distance);
        block =
            across * Eigen::Matrix3d::Identity() + (1.0 - across) * far.way * far.way.transpose();
    } else if (goal.max_distance == 0.0) {
        block.setIdentity();
    }
    if (behind_backstop(goal, x).depth > 0.0) block += goal.normal * goal.normal.transpose();
    return stiffness * block;
}

void GoalEnergy::add_hessian(const Points& x, const BlockPattern& pattern, double* values) const {
    for (const VertexGoal& goal : m_limits)
        add_block(values, pattern.diagonal(goal.vertex),
                  block(goal, m_stiffness, x.row(goal.vertex)));
    for (const Drive& drive : m_drives)
        add_block(values, pattern.diagonal(drive.vertex),
                  drive.total() * Eigen::Matrix3d::Identity());
}

}  // namespace cloth
