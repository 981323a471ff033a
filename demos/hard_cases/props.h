#pragma once

#include <vector>

#include "data/core/boundary.h"
#include "data/core/garment.h"
#include "data/core/mesh.h"

/// What the scenes of the hard cases are built of.
namespace cloth {

/// From 0 at `begin` to 1 at `end` (s), with velocity 0 at both.
double eased(double time, double begin, double end);
/// The same at constant velocity.
double ramp(double time, double begin, double end);

Obstacle ball(double radius, const Vec3& centre0, const Vec3& centre1);
/// A capsule whose segment of length 2 `half` runs along y of its poses.
Obstacle capsule(double radius, double half, const Pose& pose0, const Pose& pose1);
Obstacle box(const Vec3& half_extents, const Vec3& centre0, const Vec3& centre1);

Pose placed(const Vec3& position);
/// At `position`, the y axis turned about x by `angle` (rad).
Pose turned_about_x(const Vec3& position, double angle);

/// A sheet of 0.6 m that is level (y = 0), or hangs in the plane z = 0 from y = 0.3 downwards.
TriMesh level_sheet(int vertices);
TriMesh hanging_sheet(int vertices);

/// The vertices within a clip's reach of a point: one vertex would bear the weight by few edges.
std::vector<int> clipped(const TriMesh& mesh, const std::vector<Vec3>& points, double reach = 0.05);

/// The vertices of a mesh that lie highest: a seam.
std::vector<int> top_seam(const TriMesh& mesh);

}  // namespace cloth
