#include "bullet_ext/clothStep.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>

#include "bullet_ext/rigidImpulse.h"
#include "bullet_ext/softBodyGarment.h"

namespace cloth {

std::vector<int> nodesHeldByGoals(const ClothStep& step) {
    constexpr double kAtLimit = 1e-4;  // m
    std::vector<int> nodes;
    if (!step.garment.has_goals()) return nodes;
    const GoalLimits& limits = step.garment.goal_limits();
    std::vector<VertexGoal> goals;
    take_goals(limits, step.boundary.goals, step.garment.is_pinned(), 1.0, goals);
    for (VertexGoal& goal : goals) {
        goal.max_distance = std::max(0.0, goal.max_distance - kAtLimit);
        goal.backstop -= kAtLimit;
        if (goal.excess(step.to.x.row(goal.vertex)) > 0.0 || goal.max_distance == 0.0)
            nodes.push_back(goal.vertex);
    }
    for (Eigen::Index i = 0; i < step.garment.vertex_count(); ++i)
        if ((limits.drive_stiffness.size() > 0 && limits.drive_stiffness[i] > 0.0) ||
            (limits.drive_damping.size() > 0 && limits.drive_damping[i] > 0.0))
            nodes.push_back(static_cast<int>(i));
    return nodes;
}

bool floatsFreely(const btSoftBody& body, const ClothStep& step) {
    if (step.garment.has_goals()) return false;
    for (int pin : step.garment.pins())
        if (!(body.m_nodes[pin].m_im > 0)) return false;
    for (int a = 0; a < body.m_anchors.size(); ++a)
        if (!isDynamic(*body.m_anchors[a].m_body)) return false;
    if (!linkAnchors(body).empty()) return false;
    return std::all_of(step.near.begin(), step.near.end(),
                       [](const NearSolid& solid) { return solid.body != nullptr; });
}

bool allSolidsKnown(const ClothStep& step) {
    size_t parts = 0;
    for (const NearSolid& solid : step.near) parts += solid.parts->size();
    return parts == step.boundary.obstacles.size();
}

bool obstaclesStand(const Boundary& boundary) {
    return std::all_of(
        boundary.obstacles.begin(), boundary.obstacles.end(), [](const Obstacle& obstacle) {
            return obstacle.pose0.matrix() == obstacle.pose1.matrix() && obstacle.x0 == obstacle.x1;
        });
}

}  // namespace cloth
