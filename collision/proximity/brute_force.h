#pragma once

#include <optional>

#include "collision/proximity/proximity.h"
#include "data/core/mesh.h"

namespace cloth {

/// The slow, obvious twin of Proximity: the oracle of its tests. It shares the closest point of one
/// triangle and of one primitive, which have tests of their own; what it must not share is the
/// search and the sign, so the pseudonormal is worked out here once more, from the bare faces.

/// Closest point of a surface to a query point.
struct SurfacePoint {
    int face = 0;                     ///< lowest face that attains the minimum
    Vec3 barycentric = Vec3::Zero();  ///< in that face
    Vec3 point = Vec3::Zero();        ///< (m)
    double distance = 0.0;            ///< unsigned (m)
};

/// Closest point over all faces with area; nothing if there is none.
std::optional<SurfacePoint> brute_force_closest(const TriMesh& mesh, const Vec3& q);

/// Signed distance (m) of q to a closed mesh: the sign of (q - p) . n with p the closest point and
/// n the angle-weighted pseudonormal of the face, edge or vertex on which p lies. Baerentzen and
/// Aanaes, "Signed distance computation using the angle weighted pseudonormal" (2005). +inf: no
/// usable face.
double brute_force_signed_distance(const TriMesh& mesh, const Vec3& q);

/// Signed distance (m) of q to the nearest obstacle at one end of the step, at any distance; the
/// smallest over all obstacles, +inf if there is none.
double brute_force_signed_distance(const Boundary& boundary, StepEnd end, const Vec3& q);

}  // namespace cloth
