#pragma once

#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// A piece of a body's surface that moves almost rigidly, for solvers that know convex hulls only.
struct BodySegment {
    int joint = -1;             ///< the joint that moves it
    std::vector<int> vertices;  ///< of the body's mesh: those it is fitted to
    Points rest;                ///< |vertices| x 3 (m): where they are in the rest pose
    Points hull_points_rest;    ///< corners of their convex hull in the rest pose (m)
};

/// Cuts a body into pieces that are nearly convex: one for each joint that moves skin, then the
/// piece whose hull stands off the skin most is cut in two, again and again. All cuts of a joint
/// are across one axis, so that pieces are slabs with whole cross-sections: Bullet pushes a point
/// inside a hull out through the nearest side, and from a piece that is a mere shell that may be
/// the wrong one. Slabs share the faces along their cuts, so hulls leave no gap.
///
/// @param rest            the body's surface in the rest pose
/// @param dominant_joint  the joint that moves each vertex most (|V|)
/// @param target_count    pieces at most (or one for each joint), 1 to 1000; fewer if all hulls
///                        stand off less than 2 mm or all slabs are thinner than 4 cm
/// @throws ArgumentError if the mesh, the joints or the count are unusable
std::vector<BodySegment> segment_body(const TriMesh& rest, const std::vector<int>& dominant_joint,
                                      int target_count = 70);

/// How far the hull of a segment stands off the surface at most (m): the depth of its deepest
/// vertex below the hull.
double hull_standoff(const BodySegment& segment);

}  // namespace cloth
