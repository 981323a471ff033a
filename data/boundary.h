#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "data/types.h"

namespace cloth {

using Pose = Eigen::Isometry3d;

enum class ObstacleShape { mesh, sphere, capsule, box, plane };

/// One solid surface that cloth must stay outside of, at the start (t) and end (t + dt) of a step.
///
/// A mesh keeps its `faces` for life (the query structure is cached by that pointer) and moves its
/// vertices. The primitives stand in their own frame: a sphere at the origin; a capsule along y; a
/// box with half extents; a plane through the origin, solid on the side y < 0.
struct Obstacle {
    ObstacleShape shape = ObstacleShape::mesh;
    std::shared_ptr<const Faces> faces;  ///< mesh: (|F| x 3), counter-clockwise seen from outside
    Points x0;                           ///< mesh: vertices at t (m)
    Points x1;                           ///< mesh: vertices at t + dt (m)
    Pose pose0 = Pose::Identity();       ///< primitive: frame at t
    Pose pose1 = Pose::Identity();       ///< primitive: frame at t + dt
    Vec3 half_extents = Vec3::Zero();    ///< box (m); capsule: y is half the segment's length
    double radius = 0.0;                 ///< sphere and capsule (m); box: rounding
    double friction = 0.5;               ///< Coulomb coefficient, 0 to 1.5
};

/// All that a stepper knows of the outside for one step.
struct Boundary {
    std::vector<Obstacle> obstacles;
    Points pin_targets;                   ///< |pins| x 3 (m): where the garment's pins are at t + dt
    Vec3 gravity = Vec3(0, -9.81, 0);     ///< (m/s^2)
    Points accelerations;                 ///< |V| x 3 (m/s^2) such as wind, or empty
};

}  // namespace cloth
