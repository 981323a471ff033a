#pragma once

#include "collision/proximity/ridge_contacts.h"
#include "gnn/physics/energy/incremental_potential.h"

namespace cloth {

/// The incremental potential of one step, with the energies that a solver's result is held against.
class StepEnergies {
 public:
    explicit StepEnergies(const Garment& garment) : m_ridges(garment), m_potential(garment) {}

    /// Sets up the step from `state` across `boundary`.
    void begin(const ClothState& state, const Boundary& boundary, double dt);

    const IncrementalPotential& potential() const { return m_potential; }
    double guess_energy() const { return m_guess_energy; }  ///< of the projected extrapolation (J)
    double still_energy() const { return m_still_energy; }  ///< of x_t, pins at their targets (J)

    /// Lowest energy (J) that many quasi-Newton iterations reach from `x`.
    double minimum_from(Points x) const;

    /// (E(x) - minimum) / (E(projected extrapolation) - minimum)
    double gap(double energy, double minimum) const;
    /// (E(x) - minimum) / (E(x_t) - minimum)
    double progress(double energy, double minimum) const;

 private:
    Proximity m_proximity;
    RidgeFinder m_ridges;
    SurfaceContacts m_contacts;
    IncrementalPotential m_potential;
    double m_guess_energy = 0.0;
    double m_still_energy = 0.0;
};

}  // namespace cloth
