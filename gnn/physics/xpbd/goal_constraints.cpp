#include "gnn/physics/xpbd/goal_constraints.h"

namespace cloth {
namespace {

double at(const VectorX& values, Eigen::Index i) {
    return values.size() > 0 ? values[i] : 0.0;
}

}  // namespace

void GoalConstraints::begin_step(const SkinGoals& goals, double dt, int substeps) {
    m_limits.clear();
    m_drives.clear();
    if (!m_garment->has_goals()) return;
    m_length = 1.0 / substeps;
    const double h = dt * m_length;
    const GoalLimits& limits = m_garment->goal_limits();
    std::vector<VertexGoal> ends;
    take_goals(limits, goals, m_garment->is_pinned(), 1.0, ends);
    for (const VertexGoal& end : ends) {
        const Eigen::Index i = end.vertex;
        Limit limit{end, goals.x0.row(i), goals.x1.row(i) - goals.x0.row(i), end.normal,
                    Vec3::Zero()};
        if (!end.normal.isZero(0.0)) {
            limit.normal = goals.normal0.row(i);
            limit.turn = goals.normal1.row(i) - goals.normal0.row(i);
        }
        m_limits.push_back(limit);
    }
    for (Eigen::Index i = 0; i < m_garment->vertex_count(); ++i) {
        const double pull = at(limits.drive_stiffness, i), drag = at(limits.drive_damping, i);
        if (m_garment->is_pinned()[static_cast<size_t>(i)] || pull + drag == 0.0) continue;
        m_drives.push_back({static_cast<int>(i), goals.x0.row(i), goals.x1.row(i) - goals.x0.row(i),
                            pull * h * h, drag * h});
    }
}

void GoalConstraints::begin_substep(int substep) {
    m_progress = substep * m_length;
    for (Limit& limit : m_limits) {
        limit.goal.place = limit.place + m_progress * limit.move;
        if (limit.goal.normal.isZero(0.0)) continue;
        const Vec3 normal = limit.normal + m_progress * limit.turn;
        const double length = normal.norm();
        if (length > 0.0) limit.goal.normal = normal / length;
    }
}

void GoalConstraints::drive(const PaddedPoints& before, PaddedPoints& x) const {
    for (const Drive& drive : m_drives) {
        const Vec3 goal = drive.place + m_progress * drive.move;
        const Vec3 carried = before.row(drive.vertex).head<3>().transpose() + m_length * drive.move;
        auto place = x.row(drive.vertex).head<3>();
        place = (place + drive.pull * goal.transpose() + drive.drag * carried.transpose()) /
                (1.0 + drive.pull + drive.drag);
    }
}

void GoalConstraints::project(PaddedPoints& x) const {
    for (const Limit& limit : m_limits) {
        const Vec3 place = x.row(limit.goal.vertex).head<3>();
        if (limit.goal.excess(place) > 0.0)
            x.row(limit.goal.vertex).head<3>() = limit.goal.within(place).transpose();
    }
}

}  // namespace cloth
