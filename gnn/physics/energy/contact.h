#pragma once

#include <vector>

#include "collision/proximity/proximity.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// Contact with obstacles: E = sum w max(0, eps - d_i)^3, where d_i = (x_i - p_i) . n_i is the
/// distance to the tangent plane of the surface point p_i that was closest at t, both taken at
/// t + dt. As in HOOD the weight w (N/m^2) is per vertex, not per area: with w = 5e5 a vertex of
/// 1e-5 kg rests 8 micrometres inside eps.
class ContactEnergy {
 public:
    /// Takes the contacts that exist; the others cost nothing.
    /// @param distance  eps (m)
    void begin_step(const SurfaceContacts& contacts, double distance);

    /// @param weight  w (N/m^2)
    double value(const Points& x, double weight) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, double weight, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite by itself, to a matrix of `pattern`.
    void add_hessian(const Points& x, double weight, const BlockPattern& pattern,
                     double* values) const;

 private:
    struct Plane {
        Eigen::Index vertex;
        Vec3 normal;    ///< at t + dt
        double offset;  ///< p . n + eps (m): the energy starts below this height
    };
    std::vector<Plane> m_planes;
};

}  // namespace cloth
