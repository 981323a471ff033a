#include "gnn/physics/solver/goal_hessian.h"

#include <algorithm>

namespace cloth {
namespace {

constexpr double excess_per_step = 1e-4;  // m: as contact_hessian's

/// Slope of the secant of the force k max(0, u) from one depth u to a larger one.
double secant(double stiffness, double before, double after) {
    return stiffness * (after - std::max(before, 0.0)) / (after - before);
}

/// Blocks of the limits that are crossed on the way.
Eigen::Matrix3d crossed(const VertexGoal& goal, double stiffness, const Vec3& from,
                        const Vec3& to) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    const Vec3 away = to - goal.place;
    const double before = (from - goal.place).norm() - goal.max_distance;
    const double after = away.norm() - goal.max_distance;
    if (before <= 0.0 && after > 0.0 && goal.max_distance > 0.0)
        block += secant(stiffness, before, after) * away * away.transpose() / away.squaredNorm();
    if (goal.normal.isZero(0.0)) return block;
    const double height = -goal.backstop - (from - goal.place).dot(goal.normal);
    const double depth = -goal.backstop - away.dot(goal.normal);
    if (height <= 0.0 && depth > 0.0)
        block += secant(stiffness, height, depth) * goal.normal * goal.normal.transpose();
    return block;
}

}  // namespace

double allowed_excess(const VertexGoal& goal, const Vec3& x) {
    return goal.excess(x) + excess_per_step;
}

void limit_excess(const VertexGoal& goal, double allowed, Points& x) {
    VertexGoal wider = goal;
    wider.max_distance += allowed;
    wider.backstop += allowed;
    const Vec3 at = x.row(goal.vertex);
    if (wider.excess(at) > 0.0) x.row(goal.vertex) = wider.within(at).transpose();
}

void GoalHessian::begin_step(const GoalEnergy& energy, const std::vector<int>& row_of) {
    m_energy = &energy;
    m_row_of = &row_of;
    m_blocks.clear();
}

void GoalHessian::linearise(const Points& x) {
    m_blocks.clear();
    m_from.clear();
    for (const VertexGoal& goal : m_energy->limits()) {
        m_from.push_back(x.row(goal.vertex));
        const Eigen::Matrix3d block = GoalEnergy::block(goal, m_energy->stiffness(), m_from.back());
        if (!block.isZero(0.0))
            m_blocks.push_back({(*m_row_of)[static_cast<size_t>(goal.vertex)], block});
    }
    for (const GoalEnergy::Drive& drive : m_energy->drives())
        m_blocks.push_back({(*m_row_of)[static_cast<size_t>(drive.vertex)],
                            drive.total() * Eigen::Matrix3d::Identity()});
}

void GoalHessian::anticipate(const Points& step) {
    const std::vector<VertexGoal>& limits = m_energy->limits();
    for (size_t k = 0; k < limits.size(); ++k) {
        const int row = (*m_row_of)[static_cast<size_t>(limits[k].vertex)];
        const Vec3 to = m_from[k] + step.row(row).transpose();
        const Eigen::Matrix3d block = crossed(limits[k], m_energy->stiffness(), m_from[k], to);
        if (!block.isZero(0.0)) m_blocks.push_back({row, block});
    }
}

void GoalHessian::limit(Points& trial) const {
    const std::vector<VertexGoal>& limits = m_energy->limits();
    for (size_t k = 0; k < limits.size(); ++k)
        limit_excess(limits[k], allowed_excess(limits[k], m_from[k]), trial);
}

}  // namespace cloth
