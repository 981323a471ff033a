#include "demos/viewer/cloth_pull.h"

#include <algorithm>
#include <limits>

#include "data/core/check_range.h"

namespace cloth {
namespace {

std::vector<std::vector<int>> neighbours_of(const Garment& garment) {
    std::vector<std::vector<int>> neighbours(static_cast<size_t>(garment.vertex_count()));
    for (const auto& [a, b] : garment.edges()) {
        neighbours[static_cast<size_t>(a)].push_back(b);
        neighbours[static_cast<size_t>(b)].push_back(a);
    }
    return neighbours;
}

/// Vertices that hang together with the first one and are within the radius: not those of a layer
/// below.
std::vector<int> patch_around(const Garment& garment, int vertex, double radius) {
    const auto neighbours = neighbours_of(garment);
    const Points& rest = garment.rest().vertices;
    std::vector<char> seen(neighbours.size());
    std::vector<int> patch = {vertex};
    seen[static_cast<size_t>(vertex)] = 1;
    for (size_t k = 0; k < patch.size(); ++k)
        for (const int j : neighbours[static_cast<size_t>(patch[k])]) {
            if (seen[static_cast<size_t>(j)]++) continue;
            if ((rest.row(j) - rest.row(vertex)).norm() < radius) patch.push_back(j);
        }
    return patch;
}

}  // namespace

ClothPull::ClothPull(const Garment& garment, int vertex, const PullSettings& settings)
    : m_vertex(vertex), m_settings(settings) {
    check_range("PullSettings.stiffness", settings.stiffness, 1.0, 200.0);
    check_range("PullSettings.radius", settings.radius, 5e-3, 0.2);
    check_range("PullSettings.max_distance", settings.max_distance, 0.01, 1.0);
    check_range("the vertex to be pulled", vertex, 0,
                static_cast<double>(garment.vertex_count() - 1));
    m_patch = patch_around(garment, vertex, settings.radius);
    m_drive = VectorX::Zero(garment.vertex_count());
    const Points& rest = garment.rest().vertices;
    double sum = 0.0;
    for (const int i : m_patch) {
        const double away = (rest.row(i) - rest.row(vertex)).norm() / settings.radius;
        m_drive[i] = (1.0 - away * away) * (1.0 - away * away);
        sum += garment.masses()[i] * m_drive[i];
    }
    constexpr double most = 1e6;  // of GoalLimits: a patch of one light vertex is pulled less
    m_drive = (m_drive * (settings.stiffness / sum)).cwiseMin(most);
}

GoalLimits ClothPull::limits(const GoalLimits& own) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    GoalLimits limits = own;
    if (limits.drive_stiffness.size() == 0) limits.drive_stiffness.setZero(m_drive.size());
    for (const int i : m_patch) {
        limits.drive_stiffness[i] = m_drive[i];
        if (limits.drive_damping.size() > 0) limits.drive_damping[i] = 0.0;
        if (limits.max_distance.size() > 0) limits.max_distance[i] = infinity;
        if (limits.backstop.size() > 0) limits.backstop[i] = infinity;
    }
    return limits;
}

SkinGoals ClothPull::goals(const Points& x, const Vec3& target, const GoalLimits& own,
                           const SkinGoals& skin) const {
    Vec3 pull = target - x.row(m_vertex).transpose();
    const double distance = pull.norm();
    if (distance > m_settings.max_distance) pull *= m_settings.max_distance / distance;
    SkinGoals goals = skin.empty() ? SkinGoals::at(x) : skin;
    for (const int i : m_patch) {
        goals.x0.row(i) = x.row(i);
        goals.x1.row(i) = x.row(i) + pull.transpose();
    }
    if (skin.empty()) return goals;
    std::vector<VertexGoal> allowed;
    take_goals(own, skin, std::vector<char>(static_cast<size_t>(x.rows()), 0), 1.0, allowed);
    for (const VertexGoal& goal : allowed)
        if (m_drive[goal.vertex] > 0.0)
            goals.x1.row(goal.vertex) = goal.within(goals.x1.row(goal.vertex));
    return goals;
}

}  // namespace cloth
