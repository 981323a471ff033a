#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "data/core/boundary.h"

namespace cloth {

/// Contact of a point within a garment's face, or on its edge, with an obstacle: the tangent plane
/// of the surface point that was closest at t, at t + dt. See RidgeFinder.
struct RidgeContact {
    int face = 0;                  ///< of the garment
    std::array<double, 3> weight;  ///< of the face's corners, 0 to 1
    Vec3 normal;                   ///< unit, outward
    double height = 0.0;           ///< of the plane: surface point . normal (m)
    Vec3 normal0 = Vec3::Zero();   ///< at t
    Vec3 point0 = Vec3::Zero(), point1 = Vec3::Zero();  ///< the surface point at t, t + dt (m)
};

/// Nearest surface points of a set of query points, one row each. The closest point is chosen on
/// the surfaces at t and carried along to t + dt (same face, same barycentric coordinates). Rows
/// without a contact are zero, their distance is infinite.
struct SurfaceContacts {
    std::vector<int> obstacle;  ///< |V|: index into Boundary::obstacles, -1: none within the radius
    std::vector<int> face;      ///< |V|: face of a mesh obstacle, -1 for primitives
    Points barycentric;       ///< |V| x 3: coordinates in that face, or local frame of a primitive
    Points point0, point1;    ///< |V| x 3 (m): the surface point at t and at t + dt
    Points normal0, normal1;  ///< |V| x 3: unit face normal there (outward) at t and at t + dt
    VectorX distance;         ///< |V| (m): signed distance at t, negative inside; +inf: none
    VectorX clearance;        ///< |V| (m): no surface is nearer. The distance, or else the radius;
                              ///< more where there are no meshes: primitives are seen from afar
    std::vector<RidgeContact> ridges;  ///< faces and edges over ridges; a query leaves it empty

    bool has(Eigen::Index i) const { return obstacle[static_cast<size_t>(i)] >= 0; }
    /// No contacts at all, as where there are no obstacles.
    void clear() {
        obstacle.clear();
        ridges.clear();
    }
    /// Mean velocity of the surface point over the step (m/s).
    Vec3 velocity(Eigen::Index i, double dt) const { return (point1.row(i) - point0.row(i)) / dt; }
};

struct ProximitySettings {
    double radius = 0.1;  ///< how far a query looks (m), 0.01 to 2; larger costs time
    int threads = 0;      ///< 0 to 1024; 0: as many as OpenMP gives; results do not depend on it
};

/// What a query leaves out.
struct QueryLimits {
    const std::vector<LimbSet>* ignored = nullptr;  ///< limbs that each row passes over; null:
                                                    ///< Boundary::ignored_limbs, if it fits
    double radius = std::numeric_limits<double>::infinity();  ///< look no farther than this (m),
                                                              ///< nor than ProximitySettings
    const VectorX* radii = nullptr;  ///< the same for each row (m); null: one for all
    /// Rows that are farther than this (m, negative: inside) get a clearance and no contact.
    double store_within = std::numeric_limits<double>::infinity();
};

/// What lies over a surface point of a mesh, see Proximity::cover().
struct Cover {
    static constexpr double farthest = 0.5;  ///< that is looked at (m): thicker than any limb
    double depth = 0.0;                      ///< how much of it (m, along the normal), above 0
    int face = 0;                            ///< its face on the far side
};

/// Nearest-point queries against the obstacles of a Boundary, on FCL's bounding volume hierarchies.
///
///     Proximity proximity;
///     proximity.query(state.x, boundary, contacts);
///     if (contacts.has(i) && contacts.distance[i] < 0) { ... vertex i is inside ... }
///
/// The hierarchies are those of Boundary::trees, which all garments of a world share, else its own:
/// built when the `faces` pointer of a mesh is first seen, and refitted afterwards. The closest
/// face of the previous query of the same vertex bounds the next one. A point that was asked last
/// for the same surface, as at the start of a step after the end of the one before, is not searched
/// for again, unless a limb is passed over to which what was found belongs. A mesh that no query
/// has shown for a while is forgotten. Results depend on the arguments alone: not on earlier
/// queries, nor on whose hierarchies they are, nor on the number of threads.
///
/// Of several obstacles, the smallest signed distance wins. A point that is deeper inside a mesh
/// than the radius has no contact, like one far outside; in a primitive every depth is seen. Points
/// with coordinates that are not finite have no contact. Unusable obstacles (see check_obstacles)
/// are passed over: nothing on the per-frame path throws. The constructor throws ArgumentError.
class Proximity {
 public:
    /// @param trees  used where Boundary::trees is null; whoever gives it calls its begin_step().
    ///               Null, or made for smaller radii: the object's own
    explicit Proximity(ProximitySettings settings = {},
                       std::shared_ptr<ObstacleTrees> trees = nullptr);
    ~Proximity();
    Proximity(Proximity&&) noexcept;
    Proximity& operator=(Proximity&&) noexcept;

    const ProximitySettings& settings() const;

    /// Nearest points at t of the points `x` (|V| x 3, m), carried to t + dt.
    /// @param chosen_at  end: nearest points at t + dt, carried back to t
    void query(const Points& x, const Boundary& boundary, SurfaceContacts& contacts,
               StepEnd chosen_at = StepEnd::start, const QueryLimits& limits = {});

    /// Repeats a query for some rows of `x` only (ascending or not, each at most once); the other
    /// rows of `contacts`, which has |V| rows from a query before, are left as they are.
    void query_rows(const Points& x, const std::vector<int>& rows, const Boundary& boundary,
                    SurfaceContacts& contacts, StepEnd chosen_at = StepEnd::start,
                    const QueryLimits& limits = {});

    /// Signed distance (m) of `x` to the surfaces at one end of the step; +inf beyond the radius.
    /// Boundary::ignored_limbs is used if it has as many rows.
    void signed_distance(const Points& x, const Boundary& boundary, StepEnd end, VectorX& distance);

    /// The part of its own mesh that lies over row i's surface point, up to Cover::farthest. To be
    /// asked right after the query, for the same end.
    /// @param ignored  limbs that do not count
    std::optional<Cover> cover(const SurfaceContacts& contacts, Eigen::Index i, StepEnd chosen_at,
                               LimbSet ignored = 0);

    /// The same for several rows, on several threads, at either end and whatever was asked before.
    /// @param contacts  of a query of the same boundary
    /// @param end       where the surface points are looked at, wherever they were chosen
    /// @param ignored   |V|: limbs that do not count for each row
    /// @param covers    |rows|: what lies over each of `rows`
    void cover_rows(const Boundary& boundary, const SurfaceContacts& contacts,
                    const std::vector<int>& rows, StepEnd end, const std::vector<LimbSet>& ignored,
                    std::vector<std::optional<Cover>>& covers);

    /// Meshes that are remembered at present.
    int cached_meshes() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// For set-up code: throws ArgumentError, naming the obstacle, if a query would have to pass it
/// over (no faces, indices out of range, x0 or x1 without those vertices or not finite, bad sizes).
void check_obstacles(const Boundary& boundary);

}  // namespace cloth
