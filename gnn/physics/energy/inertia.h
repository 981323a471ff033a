#pragma once

#include "data/core/cloth_state.h"
#include "data/core/garment.h"
#include "gnn/physics/energy/block_pattern.h"
#include "gnn/physics/energy/time_integration.h"

namespace cloth {

/// Inertia of one step: E = sum w_i m_i / (2 dt^2) |x_i - target_i|^2, by backward Euler (target
/// x_t + dt v_t, w = 1) unless a TimeIntegration says otherwise.
class InertiaEnergy {
 public:
    /// Keeps a reference to `garment`.
    explicit InertiaEnergy(const Garment& garment) : m_garment(&garment) {}

    /// @param step  null: backward Euler
    void begin_step(const ClothState& state, double dt, const InertialStep* step = nullptr);

    const Points& target() const { return m_target; }         ///< |V| x 3 (m)
    const VectorX& stiffness() const { return m_stiffness; }  ///< |V|: w m / dt^2 (N/m)

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
