#pragma once

#include <memory>
#include <vector>

#include "bullet_ext/bulletTypes.h"
#include "data/core/boundary.h"
#include "data/core/mesh.h"

class btCollisionShape;

namespace cloth {

/// One solid in the frame of a collision shape: a primitive at `frame`, or a mesh of `vertices`.
struct ShapePart {
    ObstacleShape shape = ObstacleShape::mesh;
    Pose frame = Pose::Identity();       ///< primitive: its frame in the frame of the whole shape
    Vec3 half_extents = Vec3::Zero();    ///< as Obstacle::half_extents (m)
    double radius = 0.0;                 ///< as Obstacle::radius (m)
    std::shared_ptr<const Faces> faces;  ///< mesh: (|F| x 3), counter-clockwise seen from outside
    Points vertices;                     ///< mesh: (|V| x 3, m), in the frame of the whole shape
};

/// The surface of a Bullet collision shape as obstacles. Spheres, boxes, capsules and planes stay
/// what they are; every other convex shape (hull, cylinder, cone, ...) becomes a mesh without
/// Bullet's collision margin; every concave shape (triangle mesh, scaled, GImpact, heightfield)
/// becomes its triangles; compounds become their children's parts. Faces of meshes that are
/// mirrored by their scaling are turned back; those of heightfields face up along its axis.
///
/// @return  empty if the shape is empty or of a kind that has no surface
std::vector<ShapePart> partsOfShape(const btCollisionShape& shape);

/// Convex hull of points (|P| x 3, m): faces counter-clockwise from outside; no faces if the points
/// span no volume.
TriMesh convexHull(const Points& points);

}  // namespace cloth
