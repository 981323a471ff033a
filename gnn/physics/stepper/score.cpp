#include "gnn/physics/stepper/score.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "collision/proximity/ridge_contacts.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

// A step without anything to gain has a gap of 0, not 0/0.
double ratio(double part, double whole) {
    constexpr double smallest = 1e-14;  // J
    return std::abs(part) <= smallest ? 0.0 : part / std::max(whole, smallest);
}

SurfaceContacts contacts_of(const Garment& garment, const ClothState& state,
                            const Boundary& boundary) {
    SurfaceContacts contacts;
    if (boundary.obstacles.empty()) return contacts;
    Proximity proximity;
    proximity.query(state.x, boundary, contacts);
    RidgeFinder(garment).find(proximity, boundary, state.x, contacts);
    return contacts;
}

}  // namespace

Minimiser newton_minimiser(const Garment& garment, const NewtonSettings& settings) {
    auto newton = std::make_shared<Newton>(garment, settings);
    return [newton](const IncrementalPotential& potential, Points& x) {
        return newton->minimise(potential, x);
    };
}

Minimiser patient_quasi_newton(const Garment& garment) {
    QuasiNewtonSettings settings;
    settings.iterations = 2000;
    settings.tolerance = 1e-5;
    settings.history = 20;
    settings.contact_cg_iterations = 10;
    auto solver = std::make_shared<QuasiNewton>(garment, settings);
    return [solver](const IncrementalPotential& potential, Points& x) {
        return solver->minimise(potential, x);
    };
}

StepReference::StepReference(const Garment& garment, const PotentialSettings& settings,
                             const ClothState& state, const Boundary& boundary, double dt,
                             const Minimiser& minimiser)
    : m_potential(garment, settings) {
    if (!is_valid_step(garment, state, boundary, dt))
        throw ArgumentError("StepReference of " + garment.name(),
                            "state, boundary or time step is not finite or of other sizes",
                            "pass the state and boundary of a step of this garment");
    const SurfaceContacts contacts = contacts_of(garment, state, boundary);
    m_potential.begin_step(state, boundary, contacts, dt);
    starting_guess(garment, state, boundary, contacts, dt, settings.contact_distance, m_guess);
    m_potential.separate_self_contact(m_guess);
    Points still = state.x;
    place_pins(garment, boundary, still);
    m_guess_energy = m_potential.value(m_guess);
    m_still_energy = m_potential.value(still);
    m_report.finite = false;
    if (!try_from(m_guess, minimiser))
        throw ArgumentError("StepReference of " + garment.name(), "the minimiser failed",
                            "check that it was made for this garment and the state is not torn");
}

bool StepReference::try_from(Points start, const Minimiser& minimiser) {
    const MinimiseReport report = minimiser(m_potential, start);
    if (!report.finite || (m_report.finite && report.energy >= m_report.energy)) return false;
    m_report = report;
    m_minimum = std::move(start);
    return true;
}

StepScore StepReference::score(const Points& x) const {
    StepScore score;
    score.terms = m_potential.terms(x);
    score.energy = score.terms.total();
    const double excess = score.energy - minimum_energy();
    score.gap = ratio(excess, m_guess_energy - minimum_energy());
    score.progress = ratio(excess, m_still_energy - minimum_energy());
    score.rmse_mm = 1e3 * std::sqrt((x - m_minimum).rowwise().squaredNorm().mean());
    return score;
}

}  // namespace cloth
