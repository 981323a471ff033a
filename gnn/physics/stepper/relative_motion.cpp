#include "gnn/physics/stepper/relative_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "data/core/primitives.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

constexpr double kReach = 0.05;  // surfaces this near the garment's box count (m)

using Box = Eigen::AlignedBox3d;

Box box_of(const Points& x) {
    return Box(Vec3(x.colwise().minCoeff()), Vec3(x.colwise().maxCoeff()));
}

/// The garment and where its mean motion takes it, with some reach.
Box swept_box(const ClothState& state, const Vec3& shift) {
    Box box = box_of(state.x);
    box.extend(Box(box).translate(shift));
    return Box(box.min() - Vec3::Constant(kReach), box.max() + Vec3::Constant(kReach));
}

/// Of the vertices, and of the faces: a large one may be near although no corner of it is.
double mesh_motion(const Obstacle& mesh, const Box& box, const Vec3& shift) {
    if (mesh.x0.rows() != mesh.x1.rows() || !mesh.faces) return 0.0;
    const auto path = [&](Eigen::Index i) {
        const Vec3 from = mesh.x0.row(i), to = mesh.x1.row(i);
        return Box(from.cwiseMin(to), from.cwiseMax(to));
    };
    const VectorX motion =
        ((mesh.x1 - mesh.x0).rowwise() - shift.transpose()).rowwise().squaredNorm();
    double farthest = 0.0;
    for (Eigen::Index i = 0; i < motion.size(); ++i)
        if (motion[i] > farthest && box.intersects(path(i))) farthest = motion[i];
    for (const auto& corners : mesh.faces->rowwise()) {
        if (corners.minCoeff() < 0 || corners.maxCoeff() >= motion.size()) continue;
        const double most = std::max({motion[corners[0]], motion[corners[1]], motion[corners[2]]});
        if (most <= farthest) continue;
        Box all = path(corners[0]);
        all.extend(path(corners[1]));
        all.extend(path(corners[2]));
        if (box.intersects(all)) farthest = most;
    }
    return std::sqrt(farthest);
}

/// Of a sphere around a primitive that holds it; a plane does not turn noticeably where cloth is.
double primitive_motion(const Obstacle& shape, const Box& box, const Vec3& shift) {
    const double size = shape.radius + shape.half_extents.norm();
    const Vec3 from = shape.pose0.translation(), to = shape.pose1.translation();
    const Box path(from.cwiseMin(to) - Vec3::Constant(size),
                   from.cwiseMax(to) + Vec3::Constant(size));
    if (shape.shape != ObstacleShape::plane && !box.intersects(path)) return 0.0;
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(shape.pose0.linear().transpose() * shape.pose1.linear()));
    return (to - from - shift).norm() + std::abs(turn.angle()) * size;
}

/// The longest edge as it is now (m).
double longest_edge(const Garment& garment, const Points& x) {
    double squared = 0.0;
    for (const auto& [a, b] : garment.edges())
        squared = std::max(squared, (x.row(a) - x.row(b)).squaredNorm());
    return std::sqrt(squared);
}

/// Of the vertices over a primitive, where they or their faces may come near it: a garment that
/// swings past it has parts that are slow, and others that are far away.
double motion_over(const Obstacle& shape, const Garment& garment, const Points& x0,
                   const Points& x1) {
    if (!is_usable_primitive(shape)) return 0.0;
    const Pose to_local0 = shape.pose0.inverse(), to_local1 = shape.pose1.inverse();
    const auto squared_way = [&](Eigen::Index i) {
        return (to_local1 * x1.row(i).transpose() - to_local0 * x0.row(i).transpose())
            .squaredNorm();
    };
    double longest = 0.0, farthest = 0.0;  // m²
    for (Eigen::Index i = 0; i < x0.rows(); ++i) longest = std::max(longest, squared_way(i));
    // No point of a triangle is farther from all corners than this share of its longest edge.
    const double near = std::sqrt(longest) + kReach + longest_edge(garment, x0) / std::sqrt(3.0);
    for (Eigen::Index i = 0; i < x0.rows(); ++i) {
        const double own = squared_way(i);
        if (own > farthest &&
            distance_to_primitive(shape, to_local0 * x0.row(i).transpose()) < near)
            farthest = own;
    }
    return std::sqrt(farthest);
}

/// Of pins over the vertices next to them, which drag what they are pulled away from.
double pin_motion_over_neighbours(const Garment& garment, const Points& x0, const Points& x1) {
    double farthest = 0.0;
    for (const auto& [a, b] : garment.edges())
        if (garment.is_pinned()[static_cast<size_t>(a)] !=
            garment.is_pinned()[static_cast<size_t>(b)])
            farthest = std::max(farthest, (x1.row(a) - x0.row(a) - x1.row(b) + x0.row(b)).norm());
    return farthest;
}

/// How far limits of goals pull vertices that move along with the garment.
double goal_motion(const Garment& garment, const Boundary& boundary, const Vec3& shift,
                   const Points& x) {
    if (!garment.has_goals()) return 0.0;
    std::vector<VertexGoal> goals;
    take_goals(garment.goal_limits(), boundary.goals, garment.is_pinned(), 1.0, goals);
    double farthest = 0.0;
    for (const VertexGoal& goal : goals)
        farthest = std::max(farthest, goal.excess(x.row(goal.vertex).transpose() + shift));
    return farthest;
}

}  // namespace

double relative_motion(const Garment& garment, const Boundary& boundary, double dt,
                       const ClothState& state) {
    if (state.x.rows() == 0) return 0.0;
    const Vec3 shift = dt * state.v.colwise().mean().transpose();
    const Box box = swept_box(state, shift);
    Points ahead = state.x + dt * state.v;
    place_pins(garment, boundary, ahead);
    double pins = 0.0;
    for (const int pin : garment.pins())
        pins = std::max(pins, (ahead.row(pin) - state.x.row(pin) - shift.transpose()).norm());
    if (pins > 0.0) pins = std::min(pins, pin_motion_over_neighbours(garment, state.x, ahead));
    double farthest = std::max(pins, goal_motion(garment, boundary, shift, state.x));
    for (const Obstacle& obstacle : boundary.obstacles) {
        const bool is_mesh = obstacle.shape == ObstacleShape::mesh;
        const double motion =
            is_mesh ? mesh_motion(obstacle, box, shift) : primitive_motion(obstacle, box, shift);
        if (motion <= farthest) continue;
        farthest = is_mesh
                       ? motion
                       : std::max(farthest,
                                  std::min(motion, motion_over(obstacle, garment, state.x, ahead)));
    }
    return farthest;
}

}  // namespace cloth
