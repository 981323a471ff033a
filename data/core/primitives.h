#pragma once

#include "data/core/boundary.h"

namespace cloth {

/// Closest surface point of a primitive obstacle, in the primitive's own frame.
struct PrimitiveHit {
    Vec3 point = Vec3::Zero();    ///< surface point (m)
    Vec3 normal = Vec3::UnitY();  ///< unit outward normal there
    double distance = 0.0;        ///< signed distance (m), negative inside at any depth
};

/// Closest surface point to `q` (m, in the primitive's frame), in closed form. The surface of a box
/// with `radius` r is the offset of the box `half_extents` by r (its outer half extents are larger
/// by r). Where the closest point is ambiguous (a sphere's centre, a capsule's axis), one is
/// chosen.
PrimitiveHit closest_on_primitive(const Obstacle& obstacle, const Vec3& q);

/// closest_on_primitive().distance alone, the same to the bit.
double distance_to_primitive(const Obstacle& obstacle, const Vec3& q);

/// Radius of the sphere around the frame's origin that holds the primitive (m); infinite: a plane.
double reach_of_primitive(const Obstacle& obstacle);

/// False if the sizes that the shape uses are negative or not finite, a pose is not finite, or the
/// obstacle is a mesh.
bool is_usable_primitive(const Obstacle& obstacle);

}  // namespace cloth
