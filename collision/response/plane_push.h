#pragma once

#include <array>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Where normal . x >= height.
struct HalfSpace {
    Vec3 normal;    ///< unit
    double height;  ///< (m)
};

/// The smallest motion, weighted with the masses, that lifts combinations of vertices above planes:
///
///     minimise  sum of m |dx|^2  where  normal . (sum of weight (x + dx)) >= height
///
/// Solved in its multipliers by projected Jacobi steps in which each vertex is shared out evenly
/// among its planes (Tonge et al. 2012, "Mass splitting for jitter-free parallel rigid body
/// simulation"): no order, monotone even where planes contradict each other, and vertices that no
/// plane names stay where they are. Vertices of inverse mass 0 never move.
class PlanePush {
 public:
    /// @param inverse_masses  |V| (1/kg)
    explicit PlanePush(VectorX inverse_masses);

    void clear() { m_planes.clear(); }
    bool empty() const { return m_planes.empty(); }

    /// A weight of 0 leaves its vertex out. `normal` is a unit vector, `height` in m.
    void add(const std::array<int, 3>& vertex, const std::array<double, 3>& weight,
             const Vec3& normal, double height);
    /// The same for two elements that are to part: their weights add up to 0.
    void add_pair(const std::array<int, 4>& vertex, const std::array<double, 4>& weight,
                  const Vec3& normal, double height);

    /// Sets `marks` (|V|) to 1 for each vertex of a plane.
    void mark_vertices(std::vector<char>& marks) const;

    /// Moves the vertices of the planes, none of them further than `most` times what the lowest of
    /// all points was below its plane.
    void solve(int sweeps, double most, Points& x);

    /// Vertices of the planes of the last solve(), in the order in which they were named.
    const std::vector<int>& moved() const { return m_touched; }

 private:
    struct Plane {
        std::array<int, 4> vertex;
        std::array<double, 4> weight;
        size_t count;  ///< of its vertices, 3 or 4
        Vec3 normal;
        double height;
        double mobility = 0.0;    ///< lift per multiplier, of vertices shared out (1/kg)
        double multiplier = 0.0;  ///< (kg m)
        double change = 0.0;      ///< of the multiplier in this sweep
        double reach = 0.0;       ///< how far its point moves where each vertex moves by 1
        double idle_until = 0.0;  ///< m_path before which it lifts nothing (m)
    };

    double missing(const Plane& plane, const Points& x) const;
    double share_out(const Points& x);
    double sweep(Points& x);
    double farthest_motion(const Points& x);
    void limit(double allowed, Points& x) const;

    VectorX m_inverse_masses;
    std::vector<Plane> m_planes;
    std::vector<int> m_touched;
    std::vector<int> m_shares;  ///< |V|: planes of a vertex
    Points m_before;            ///< |V| x 3 (m)
    Points m_last;              ///< |V| x 3 (m): after the last sweep
    double m_path = 0.0;        ///< no vertex has moved farther in the sweeps so far (m)
};

}  // namespace cloth
