#include "data/core/skin_goals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "data/core/check_range.h"

namespace cloth {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double value_or(const VectorX& values, Eigen::Index i, double otherwise) {
    return values.size() > 0 ? values[i] : otherwise;
}

bool any_finite(const VectorX& values) {
    return values.array().isFinite().any();
}

bool any_positive(const VectorX& values) {
    return (values.array() > 0.0).any();
}

void check_values(const VectorX& values, Eigen::Index vertices, double most,
                  const std::string& name) {
    if (values.size() != 0 && values.size() != vertices)
        throw ArgumentError(name,
                            "has " + std::to_string(values.size()) +
                                " values where the garment has " + std::to_string(vertices) +
                                " vertices",
                            "give one value per vertex, or none at all");
    for (Eigen::Index i = 0; i < values.size(); ++i)
        check_range(name + "[" + std::to_string(i) + "]", values[i], 0.0, most);
}

bool fits(const Points& x, Eigen::Index rows) {
    return x.rows() == rows && x.allFinite();
}

/// Zero where there is no backstop.
Vec3 normal_of(const GoalLimits& limits, const SkinGoals& goals, Eigen::Index i, double progress) {
    if (!std::isfinite(value_or(limits.backstop, i, infinity))) return Vec3::Zero();
    const Vec3 normal = (1.0 - progress) * goals.normal0.row(i) + progress * goals.normal1.row(i);
    const double length = normal.norm();
    return length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
}

}  // namespace

bool GoalLimits::empty() const {
    return !any_finite(max_distance) && !has_backstops() && !any_positive(drive_stiffness) &&
           !any_positive(drive_damping);
}

bool GoalLimits::has_backstops() const {
    return any_finite(backstop);
}

void check(const GoalLimits& limits, Eigen::Index vertices, const std::string& owner) {
    const std::string name = owner + ": GoalLimits.";
    check_values(limits.max_distance, vertices, infinity, name + "max_distance");
    check_values(limits.backstop, vertices, infinity, name + "backstop");
    check_values(limits.drive_stiffness, vertices, 1e6, name + "drive_stiffness");
    check_values(limits.drive_damping, vertices, 1e4, name + "drive_damping");
}

bool are_goals_for(const GoalLimits& limits, const SkinGoals& goals, Eigen::Index vertices) {
    if (limits.empty()) return true;
    if (!fits(goals.x0, vertices) || !fits(goals.x1, vertices)) return false;
    return !limits.has_backstops() ||
           (fits(goals.normal0, vertices) && fits(goals.normal1, vertices));
}

double VertexGoal::excess(const Vec3& x) const {
    const Vec3 away = x - place;
    const double behind = normal.isZero(0.0) ? 0.0 : -backstop - away.dot(normal);
    return std::max({0.0, behind, away.norm() - max_distance});
}

Vec3 VertexGoal::within(const Vec3& x) const {
    Vec3 away = x - place;
    bool moved = false;
    if (!normal.isZero(0.0)) {
        const double behind = -backstop - away.dot(normal);
        if (behind > 0.0) away += behind * normal, moved = true;
    }
    // Towards the goal nothing gets behind the backstop.
    const double length = away.norm();
    if (length > max_distance) away *= max_distance / length, moved = true;
    return moved ? Vec3(place + away) : x;
}

void take_goals(const GoalLimits& limits, const SkinGoals& goals,
                const std::vector<char>& is_pinned, double progress,
                std::vector<VertexGoal>& taken) {
    taken.clear();
    const auto vertices = static_cast<Eigen::Index>(is_pinned.size());
    if (limits.empty() || !are_goals_for(limits, goals, vertices)) return;
    for (Eigen::Index i = 0; i < vertices; ++i) {
        if (is_pinned[static_cast<size_t>(i)]) continue;
        VertexGoal goal;
        goal.max_distance = value_or(limits.max_distance, i, infinity);
        goal.backstop = value_or(limits.backstop, i, infinity);
        goal.normal = normal_of(limits, goals, i, progress);
        if (!std::isfinite(goal.max_distance) && goal.normal.isZero(0.0)) continue;
        goal.vertex = static_cast<int>(i);
        goal.place = (1.0 - progress) * goals.x0.row(i) + progress * goals.x1.row(i);
        taken.push_back(goal);
    }
}

}  // namespace cloth
