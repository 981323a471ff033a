#pragma once

#include "data/core/primitives.h"

namespace cloth {

/// Where a path meets a primitive first and last, in the primitive's frame.
struct PrimitivePath {
    bool meets = false;
    PrimitiveHit in, out;  ///< `distance` is that of the path's start and end
};

/// Follows the straight path from p0 to p1 (m, in the primitive's frame) by conservative
/// advancement: from either end it goes on by the distance to the surface until that is below a
/// micrometre. An end that is inside is its own way in, or out.
PrimitivePath follow_path(const Obstacle& primitive, const Vec3& p0, const Vec3& p1);

/// Points that are farther than this from the primitive's frame at t (m) never meet it in a step in
/// which they move by no more than `longest_way` (m); infinite where it turns by a lot. In its
/// frame a point that is `a` away moves by no more than that, the frame's own way, and by as much
/// of a as the frame turns.
double unreachable_distance(const Obstacle& primitive, double longest_way);

}  // namespace cloth
