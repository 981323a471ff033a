#include "demos/compare/step_energies.h"

#include <algorithm>

#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {

void StepEnergies::begin(const ClothState& state, const Boundary& boundary, double dt) {
    m_proximity.query(state.x, boundary, m_contacts);
    m_ridges.find(m_proximity, boundary, state.x, m_contacts);
    m_potential.begin_step(state, boundary, m_contacts, dt);
    Points x;
    starting_guess(m_potential.garment(), state, boundary, m_contacts, dt,
                   m_potential.settings().contact_distance, x);
    m_guess_energy = m_potential.value(x);
    x = state.x;
    place_pins(m_potential.garment(), boundary, x);
    m_still_energy = m_potential.value(x);
}

double StepEnergies::minimum_from(Points x) const {
    const IterationLimits limits = IterationLimits::until(1e-4, 300);
    return QuasiNewton(m_potential.garment(), limits).minimise(m_potential, x).energy;
}

// A step whose guess is already the minimum has nothing to gain: avoid 0/0.
static double ratio(double part, double whole) {
    return part / std::max(whole, 1e-15);
}

double StepEnergies::gap(double energy, double minimum) const {
    return ratio(energy - minimum, m_guess_energy - minimum);
}

double StepEnergies::progress(double energy, double minimum) const {
    return ratio(energy - minimum, m_still_energy - minimum);
}

}  // namespace cloth
