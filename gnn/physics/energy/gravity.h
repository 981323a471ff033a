#pragma once

#include "data/core/garment.h"

namespace cloth {

/// Potential of gravity and other prescribed accelerations: E = -sum m_i a_i . x_i. It depends on
/// the origin, so energies are compared as differences between positions of one step.
class GravityEnergy {
 public:
    /// Keeps a reference to `garment`.
    explicit GravityEnergy(const Garment& garment) : m_garment(&garment) {}

    /// @param gravity   (m/s^2)
    /// @param external  |V| x 3 (m/s^2), added to gravity, or empty
    void begin_step(const Vec3& gravity, const Points& external);

    const Points& forces() const { return m_forces; }  ///< |V| x 3 (N)

    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;

 private:
    const Garment* m_garment;
    Points m_forces;
};

}  // namespace cloth
