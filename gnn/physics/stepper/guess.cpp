#include "gnn/physics/stepper/guess.h"

#include <cmath>
#include <vector>

#include "collision/response/resolve.h"

namespace cloth {

void linear_extrapolation(const ClothState& state, double dt, Points& x) {
    x = state.x + dt * state.v;
}

void projected_extrapolation(const ClothState& state, const SurfaceContacts& contacts, double dt,
                             double contact_distance, Points& x) {
    linear_extrapolation(state, dt, x);
    if (!contacts.obstacle.empty()) project_out(contacts, contact_distance, x);
}

void place_pins(const Garment& garment, const Boundary& boundary, Points& x) {
    for (size_t k = 0; k < garment.pins().size(); ++k)
        x.row(garment.pins()[k]) = boundary.pin_targets.row(static_cast<Eigen::Index>(k));
}

void move_to_goals(const Garment& garment, const Boundary& boundary, Points& x) {
    if (!garment.has_goals()) return;
    std::vector<VertexGoal> goals;
    take_goals(garment.goal_limits(), boundary.goals, garment.is_pinned(), 1.0, goals);
    for (const VertexGoal& goal : goals)
        x.row(goal.vertex) = goal.within(x.row(goal.vertex)).transpose();
}

namespace {

/// @param kept  see project_out()
void extrapolate(const Garment& garment, const ClothState& state, const Boundary& boundary,
                 const SurfaceContacts& contacts, double dt, double contact_distance, double kept,
                 Points& x) {
    linear_extrapolation(state, dt, x);
    move_to_goals(garment, boundary, x);
    if (!contacts.obstacle.empty()) project_out(contacts, contact_distance, x, kept);
    place_pins(garment, boundary, x);
}

}  // namespace

void starting_guess(const Garment& garment, const ClothState& state, const Boundary& boundary,
                    const SurfaceContacts& contacts, double dt, double contact_distance,
                    Points& x) {
    extrapolate(garment, state, boundary, contacts, dt, contact_distance, 0.0, x);
}

void resting_guess(const Garment& garment, const ClothState& state, const Boundary& boundary,
                   const SurfaceContacts& contacts, double dt, double contact_distance, Points& x) {
    constexpr double most_depth = 3e-4;  // m
    extrapolate(garment, state, boundary, contacts, dt, contact_distance, most_depth, x);
}

namespace {

bool is_finite(const Obstacle& obstacle) {
    return obstacle.x0.allFinite() && obstacle.x1.allFinite() &&
           obstacle.x0.rows() == obstacle.x1.rows() && obstacle.pose0.matrix().allFinite() &&
           obstacle.pose1.matrix().allFinite() && obstacle.half_extents.allFinite() &&
           std::isfinite(obstacle.radius) && std::isfinite(obstacle.friction);
}

bool is_finite(const Boundary& boundary) {
    for (const Obstacle& obstacle : boundary.obstacles)
        if (!is_finite(obstacle)) return false;
    return boundary.pin_targets.allFinite() && boundary.gravity.allFinite() &&
           boundary.accelerations.allFinite();
}

}  // namespace

bool is_valid_step(const Garment& garment, const ClothState& state, const Boundary& boundary,
                   double dt) {
    const Eigen::Index count = garment.vertex_count();
    const Eigen::Index pins = static_cast<Eigen::Index>(garment.pins().size());
    const Eigen::Index accelerations = boundary.accelerations.rows();
    const bool sizes =
        state.x.rows() == count && state.v.rows() == count && boundary.pin_targets.rows() == pins &&
        (accelerations == 0 || accelerations == count) &&
        are_goals_for(garment.goal_limits(), boundary.goals, count) &&
        (boundary.ignored_limbs.empty() ||
         boundary.ignored_limbs.size() == static_cast<size_t>(count)) &&
        (boundary.pinched.empty() || boundary.pinched.size() == static_cast<size_t>(count)) &&
        (boundary.overlapped.empty() || boundary.overlapped.size() == static_cast<size_t>(count));
    return sizes && std::isfinite(dt) && dt > 0.0 && state.x.allFinite() && state.v.allFinite() &&
           is_finite(boundary);
}

}  // namespace cloth
