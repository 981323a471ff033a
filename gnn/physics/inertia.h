#pragma once

#include "data/cloth_state.h"
#include "data/garment.h"
#include "gnn/physics/block_pattern.h"

namespace cloth {

/// Where each vertex would be at t + dt if no force acted: x_t + dt v_t (backward Euler). The one
/// place that knows the time integration scheme.
void compute_inertial_target(const ClothState& state, double dt, Points& target);

/// Inertia of one backward-Euler step: E = sum m_i / (2 dt^2) |x_i - target_i|^2.
class InertiaEnergy {
 public:
    /// Keeps a reference to `garment`.
    explicit InertiaEnergy(const Garment& garment) : m_garment(&garment) {}

    void begin_step(const ClothState& state, double dt);

    const Points& target() const { return m_target; }         ///< |V| x 3 (m)
    const VectorX& stiffness() const { return m_stiffness; }  ///< |V|: m / dt^2 (N/m)

    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// Adds the Hessian (N/m) to the values of a matrix of `pattern`.
    void add_hessian(const BlockPattern& pattern, double* values) const;

 private:
    const Garment* m_garment;
    Points m_target;
    VectorX m_stiffness;
};

}  // namespace cloth
