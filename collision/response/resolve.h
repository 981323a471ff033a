#pragma once

#include <algorithm>
#include <vector>

#include "collision/proximity/proximity.h"

namespace cloth {

/// Pushes every vertex of `x` (|V| x 3, m, at t + dt) that is closer than `distance` (m) to its
/// carried plane (point1, normal1) out along normal1 to that distance; one that was closer when its
/// contact was found, to where it was, but to within `kept` (m) of `distance`. Closed form, no
/// query: the guess from which solvers and networks start. Returns how many vertices it moved.
///
/// The plane is that of one face: a vertex that slides past the end of a convex part is pushed
/// although it is outside, by no more than it would have sunk below the plane.
int project_out(const SurfaceContacts& contacts, double distance, Points& x, double kept = 0.0);

/// What resolve_penetration() and ContactProjection found and left (m). What is deeper inside a
/// mesh than the proximity's radius is not seen.
struct ResolveReport {
    double max_depth_before = 0.0;  ///< deepest vertex inside an obstacle
    double max_depth_after = 0.0;
    double max_surface_depth_before = 0.0;  ///< deepest edge midpoint or face centre, once the
    double max_surface_depth_after = 0.0;   ///< vertices are out; 0: none beyond the allowed depth
    int moved = 0;                          ///< vertices that were closer than the distance
    int iterations = 0;                     ///< for the vertices alone; 0: none was closer
    int surface_iterations = 0;             ///< for edges and faces; 0: none was too deep

    double deepest_after() const { return std::max(max_depth_after, max_surface_depth_after); }
};

/// Moves the vertices in `rows` that are closer than `distance` to that distance, as
/// resolve_penetration() does. Returns the iterations; `rows` keeps those that are still closer.
/// @param contacts  the nearest points of `x`, chosen at t + dt, and of the result
/// @param moved     if not null, grows by the number of vertices that were closer
/// @param limits    of the queries that look again
int push_out_rows(Proximity& proximity, const Boundary& boundary, double distance,
                  int max_iterations, std::vector<int>& rows, Points& x, SurfaceContacts& contacts,
                  int* moved = nullptr, const QueryLimits& limits = {});

/// Contact projection of a step: queries the surfaces at t + dt and moves every vertex that is
/// closer than `distance` (m, small: 0 to 1e-3) to that distance from its closest point, again if
/// that brought it too close to another surface. Pinned vertices are moved too; callers put them
/// back.
///
/// @param contacts  the nearest points of the resulting `x`, chosen at t + dt (without obstacles it
///                  is left as it is); a caller that keeps it saves allocations
/// @param limits    of the queries
ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, SurfaceContacts& contacts, int max_iterations = 3,
                                  const QueryLimits& limits = {});

ResolveReport resolve_penetration(Proximity& proximity, const Boundary& boundary, double distance,
                                  Points& x, int max_iterations = 3);

}  // namespace cloth
