#include "gnn/physics/stepper/relative_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cloth {
namespace {

constexpr double reach = 0.05;  // surfaces this near the garment's box count (m)

using Box = Eigen::AlignedBox3d;

Box box_of(const Points& x) {
    return Box(Vec3(x.colwise().minCoeff()), Vec3(x.colwise().maxCoeff()));
}

/// The garment and where its mean motion takes it, with some reach.
Box swept_box(const ClothState& state, const Vec3& shift) {
    Box box = box_of(state.x);
    box.extend(Box(box).translate(shift));
    return Box(box.min() - Vec3::Constant(reach), box.max() + Vec3::Constant(reach));
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
    double farthest = 0.0;
    for (size_t p = 0; p < garment.pins().size(); ++p) {
        const Vec3 motion =
            boundary.pin_targets.row(static_cast<Eigen::Index>(p)) - state.x.row(garment.pins()[p]);
        farthest = std::max(farthest, (motion - shift).norm());
    }
    farthest = std::max(farthest, goal_motion(garment, boundary, shift, state.x));
    for (const Obstacle& obstacle : boundary.obstacles)
        farthest = std::max(farthest, obstacle.shape == ObstacleShape::mesh
                                          ? mesh_motion(obstacle, box, shift)
                                          : primitive_motion(obstacle, box, shift));
    return farthest;
}

}  // namespace cloth
