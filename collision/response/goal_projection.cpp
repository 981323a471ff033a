#include "collision/response/goal_projection.h"

#include <algorithm>

#include "collision/proximity/direction.h"

namespace cloth {
namespace {

constexpr double goal_tolerance = 1e-9;  // m: beyond a limit by less is within it
constexpr double fair_depth = 1e-7;      // m: less deep in an obstacle is on its surface
constexpr double fair_move =
    1e-4;                  // m: goals that move vertices less leave the faces where they are
constexpr int rounds = 4;  // of the limits and the obstacles in turn
constexpr int vertex_iterations = 3;                 // of push_out_rows
constexpr double shares[] = {0.75, 0.5, 0.25, 0.0};  // of the way from the goal, to be tried

}  // namespace

void GoalProjection::begin_step(const SkinGoals& goals) {
    m_last = {};
    m_moved.clear();
    if (!m_garment->has_goals()) return;
    take_goals(m_garment->goal_limits(), goals, m_garment->is_pinned(), 1.0, m_goals);
}

ResolveReport GoalProjection::finish(ContactProjection& projection, Proximity& proximity,
                                     const Boundary& boundary, double distance, Points& x,
                                     SurfaceContacts& contacts,
                                     const ContactProjection::WayIn& way_in) {
    ResolveReport report = projection.resolve(proximity, boundary, distance, x, contacts, way_in);
    if (m_goals.empty()) return report;
    resolve(proximity, boundary, distance, x, contacts);
    if (boundary.obstacles.empty() || m_last.max_move < fair_move) return report;
    const ResolveReport again =
        projection.resolve(proximity, boundary, distance, x, contacts, way_in);
    report.max_depth_after = again.max_depth_after;
    report.max_surface_depth_after = again.max_surface_depth_after;
    resolve(proximity, boundary, distance, x, contacts);
    return report;
}

void GoalProjection::resolve(Proximity& proximity, const Boundary& boundary, double distance,
                             Points& x, SurfaceContacts& contacts) {
    if (m_goals.empty()) return;
    m_last = {};
    bring_within(x);
    if (m_moved.empty() || boundary.obstacles.empty()) return;
    query(proximity, boundary, x, contacts);
    keep_those_inside(contacts);
    alternate(proximity, boundary, x, contacts);
    search_towards_goals(proximity, boundary, x, contacts);
    if (!m_rows.empty()) {
        // What is left are goals inside of obstacles, and their vertices are there.
        push_out_rows(proximity, boundary, distance, vertex_iterations, m_rows, x, contacts);
        measure(x);
    }
}

void GoalProjection::bring_within(Points& x) {
    m_moved.clear();
    m_inside.clear();
    m_rows.clear();
    for (size_t k = 0; k < m_goals.size(); ++k) {
        const VertexGoal& goal = m_goals[k];
        const double excess = goal.excess(x.row(goal.vertex));
        if (!(excess > goal_tolerance)) continue;
        x.row(goal.vertex) = goal.within(x.row(goal.vertex)).transpose();
        m_last.max_move = std::max(m_last.max_move, excess);
        m_moved.push_back(goal.vertex);
        m_inside.push_back({k, Vec3::Zero()});
        m_rows.push_back(goal.vertex);
    }
    m_last.moved = static_cast<int>(m_moved.size());
}

void GoalProjection::query(Proximity& proximity, const Boundary& boundary, const Points& x,
                           SurfaceContacts& contacts) {
    proximity.query_rows(x, m_rows, boundary, contacts, StepEnd::end);
    ++m_last.iterations;
}

void GoalProjection::keep_those_inside(const SurfaceContacts& contacts) {
    size_t kept = 0;
    for (size_t k = 0; k < m_rows.size(); ++k)
        if (contacts.distance[m_rows[k]] < -fair_depth) {
            m_inside[kept] = m_inside[k];
            m_rows[kept] = m_rows[k];
            ++kept;
        }
    m_inside.resize(kept);
    m_rows.resize(kept);
}

/// Onto the nearest surface, back to within the limits, and so on.
void GoalProjection::alternate(Proximity& proximity, const Boundary& boundary, Points& x,
                               SurfaceContacts& contacts) {
    for (int round = 0; round < rounds && !m_rows.empty(); ++round) {
        for (size_t k = 0; k < m_rows.size(); ++k) {
            const int i = m_rows[k];
            const VertexGoal& goal = m_goals[m_inside[k].goal];
            x.row(i) = goal.within(contacts.point1.row(i)).transpose();
        }
        query(proximity, boundary, x, contacts);
        keep_those_inside(contacts);
    }
}

/// The first place on the way to the goal that is outside, at last the goal itself.
void GoalProjection::search_towards_goals(Proximity& proximity, const Boundary& boundary, Points& x,
                                          SurfaceContacts& contacts) {
    for (size_t k = 0; k < m_rows.size(); ++k) m_inside[k].from = x.row(m_rows[k]);
    for (const double share : shares) {
        if (m_rows.empty()) return;
        for (size_t k = 0; k < m_rows.size(); ++k) {
            const Vec3& goal = m_goals[m_inside[k].goal].place;
            x.row(m_rows[k]) = (goal + share * (m_inside[k].from - goal)).transpose();
        }
        query(proximity, boundary, x, contacts);
        keep_those_inside(contacts);
    }
}

void GoalProjection::measure(const Points& x) {
    for (const Inside& inside : m_inside) {
        const VertexGoal& goal = m_goals[inside.goal];
        const double excess = goal.excess(x.row(goal.vertex));
        if (!(excess > goal_tolerance)) continue;
        ++m_last.beyond;
        m_last.max_excess = std::max(m_last.max_excess, excess);
    }
}

}  // namespace cloth
