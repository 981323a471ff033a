#pragma once

#include <memory>
#include <vector>

#include "data/boundary.h"

namespace cloth {

/// Nearest surface points of a set of query points, one row each. The closest point is chosen on the
/// surfaces at t and carried along to t + dt (same face, same barycentric coordinates).
struct SurfaceContacts {
    std::vector<int> obstacle;  ///< |V|: index into Boundary::obstacles, -1: none within the radius
    std::vector<int> face;      ///< |V|: face of a mesh obstacle, -1 for primitives
    Points barycentric;         ///< |V| x 3: coordinates in that face, or local frame of a primitive
    Points point0, point1;      ///< |V| x 3 (m): the surface point at t and at t + dt
    Points normal0, normal1;    ///< |V| x 3: unit face normal there (outward) at t and at t + dt
    VectorX distance;           ///< |V| (m): signed distance at t, negative inside; +inf: none

    bool has(Eigen::Index i) const { return obstacle[static_cast<size_t>(i)] >= 0; }
};

struct ProximitySettings {
    double radius = 0.1;  ///< how far a query looks (m), 0.01 to 0.5; larger costs time
    int threads = 0;      ///< 0: as many as OpenMP gives; results do not depend on it
};

enum class StepEnd { start, end };  ///< surfaces at t, or at t + dt

/// Nearest-point queries against the obstacles of a Boundary, on FCL's bounding volume hierarchies.
/// The hierarchy of a mesh is built when its `faces` pointer is first seen and refitted afterwards;
/// the closest face of the previous query of the same vertex bounds the next one.
class Proximity {
   public:
    explicit Proximity(ProximitySettings settings = {});
    ~Proximity();
    Proximity(Proximity&&) noexcept;
    Proximity& operator=(Proximity&&) noexcept;

    const ProximitySettings& settings() const;

    /// Nearest points at t of the points `x` (|V| x 3, m), carried to t + dt.
    void query(const Points& x, const Boundary& boundary, SurfaceContacts& contacts);

    /// Signed distance (m) of `x` to the surfaces at one end of the step; +inf beyond the radius.
    void signed_distance(const Points& x, const Boundary& boundary, StepEnd end,
                         VectorX& distance);

   private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace cloth
