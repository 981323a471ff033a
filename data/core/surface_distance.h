#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// The point of a surface that is nearest to a query point.
struct NearestPoint {
    int face = 0;
    Vec3 point = Vec3::Zero();    ///< (m)
    Vec3 weights = Vec3::Zero();  ///< barycentric coordinates of `point` in the face
    Vec3 normal = Vec3::Zero();   ///< unit vector; angle-weighted on edges and vertices
    double distance = 0.0;        ///< signed (m), negative inside
};

/// Exact signed distance to a triangle surface that does not move: what garments are fitted with.
/// (The query of the per-frame path, against moving obstacles, is collision/proximity/proximity.h.)
///
/// The sign is that of the angle-weighted normal at the nearest point, which is exact for closed
/// surfaces (Baerentzen and Aanaes 2005).
class SurfaceDistance {
 public:
    explicit SurfaceDistance(TriMesh surface);
    ~SurfaceDistance();
    SurfaceDistance(SurfaceDistance&&) noexcept;

    const TriMesh& surface() const;

    NearestPoint nearest(const Vec3& p) const;

    /// Nothing if the surface is not nearer than `radius` (m).
    std::optional<NearestPoint> nearest_within(double radius, const Vec3& p) const;

 private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// The smallest signed distance (m) from the vertices, edge midpoints and face centres of `mesh`.
double smallest_clearance(const TriMesh& mesh, const SurfaceDistance& body);

}  // namespace cloth
