#include "data/core/primitives.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth {

constexpr double coincident = 1e-12;  // m: nearer than this two points have no direction

/// The offset by `radius` of the single point `core`.
static PrimitiveHit offset_of_point(const Vec3& core, const Vec3& fallback, double radius,
                                    const Vec3& q) {
    const Vec3 away = q - core;
    const double length = away.norm();
    const Vec3 normal = length > coincident ? Vec3(away / length) : fallback;
    return {core + radius * normal, normal, length - radius};
}

/// Of the capsule's segment to `q`.
static Vec3 closest_on_segment(const Obstacle& capsule, const Vec3& q) {
    const double half = capsule.half_extents.y();
    return {0.0, std::clamp(q.y(), -half, half), 0.0};
}

/// The depth below the nearest side of a point inside a box, or on it (m).
static double depth_in_box(const Vec3& half, const Vec3& q, Eigen::Index& axis) {
    return (half - q.cwiseAbs()).minCoeff(&axis);
}

static PrimitiveHit closest_on_box(const Obstacle& box, const Vec3& q) {
    const Vec3& half = box.half_extents;
    const Vec3 clamped = q.cwiseMax(-half).cwiseMin(half);
    if ((q - clamped).norm() > coincident)
        return offset_of_point(clamped, Vec3::UnitY(), box.radius, q);
    Eigen::Index axis = 0;
    const double depth = depth_in_box(half, q, axis);
    Vec3 normal = Vec3::Zero();
    normal[axis] = q[axis] < 0 ? -1.0 : 1.0;
    Vec3 point = q;
    point[axis] = normal[axis] * (half[axis] + box.radius);
    return {point, normal, -depth - box.radius};
}

PrimitiveHit closest_on_primitive(const Obstacle& obstacle, const Vec3& q) {
    switch (obstacle.shape) {
        case ObstacleShape::sphere:
            return offset_of_point(Vec3::Zero(), Vec3::UnitY(), obstacle.radius, q);
        case ObstacleShape::capsule:
            return offset_of_point(closest_on_segment(obstacle, q), Vec3::UnitX(), obstacle.radius,
                                   q);
        case ObstacleShape::box:
            return closest_on_box(obstacle, q);
        default:
            return {Vec3(q.x(), 0.0, q.z()), Vec3::UnitY(), q.y()};
    }
}

static double distance_to_box(const Obstacle& box, const Vec3& q) {
    const Vec3& half = box.half_extents;
    const double away = (q - q.cwiseMax(-half).cwiseMin(half)).norm();
    Eigen::Index axis = 0;
    return (away > coincident ? away : -depth_in_box(half, q, axis)) - box.radius;
}

double distance_to_primitive(const Obstacle& obstacle, const Vec3& q) {
    switch (obstacle.shape) {
        case ObstacleShape::sphere:
            return q.norm() - obstacle.radius;
        case ObstacleShape::capsule:
            return (q - closest_on_segment(obstacle, q)).norm() - obstacle.radius;
        case ObstacleShape::box:
            return distance_to_box(obstacle, q);
        default:
            return q.y();
    }
}

double reach_of_primitive(const Obstacle& obstacle) {
    switch (obstacle.shape) {
        case ObstacleShape::sphere:
            return obstacle.radius;
        case ObstacleShape::capsule:
            return obstacle.half_extents.y() + obstacle.radius;
        case ObstacleShape::box:
            return obstacle.half_extents.norm() + obstacle.radius;
        default:
            return std::numeric_limits<double>::infinity();
    }
}

static bool is_size(double value) {
    return std::isfinite(value) && value >= 0.0;
}

bool is_usable_primitive(const Obstacle& obstacle) {
    if (!obstacle.pose0.matrix().allFinite() || !obstacle.pose1.matrix().allFinite()) return false;
    switch (obstacle.shape) {
        case ObstacleShape::sphere:
            return is_size(obstacle.radius);
        case ObstacleShape::capsule:
            return is_size(obstacle.radius) && is_size(obstacle.half_extents.y());
        case ObstacleShape::box:
            return is_size(obstacle.radius) && obstacle.half_extents.allFinite() &&
                   obstacle.half_extents.minCoeff() >= 0.0;
        case ObstacleShape::plane:
            return true;
        default:
            return false;
    }
}

}  // namespace cloth
