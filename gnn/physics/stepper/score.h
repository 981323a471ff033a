#pragma once

#include <functional>

#include "gnn/physics/solver/newton.h"
#include "gnn/physics/solver/quasi_newton.h"

namespace cloth {

/// How far the result of one step is from the minimum of the incremental potential.
struct StepScore {
    double gap = 0.0;       ///< (E(x) - Emin) / (E(guess) - Emin): 1 no better than the guess
    double progress = 0.0;  ///< (E(x) - Emin) / (E(x_t) - Emin): 1 no better than not moving
    double rmse_mm = 0.0;   ///< root mean square distance to the minimum, over all vertices
    double energy = 0.0;    ///< E(x) (J)
    EnergyTerms terms;      ///< E(x) by part (J)
};

/// Lowers E from x (|V| x 3), such as QuasiNewton::minimise or the reference's.
using Minimiser = std::function<MinimiseReport(const IncrementalPotential&, Points& x)>;

/// The reference's minimiser. Holds a factorisation: make it once per garment.
Minimiser newton_minimiser(const Garment& garment, const NewtonSettings& settings = {});

/// Quasi-Newton with many iterations (a residual of 1e-5 or 2,000 iterations): for soft cotton as
/// good as Newton, for stiff cotton in contact only as far as it goes.
Minimiser patient_quasi_newton(const Garment& garment);

/// What every solver's result of one step is held against: the guess that solvers start from, the
/// garment that does not move, and the lowest energy that a minimiser reaches. Built once per state
/// and boundary, then shared by all solvers.
///
///     StepReference reference(garment, {}, state, boundary, dt, newton_minimiser(garment));
///     StepScore score = reference.score(x);
class StepReference {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if no step can be made of these (sizes, numbers that are not finite)
    /// or
    ///         the minimiser fails
    StepReference(const Garment& garment, const PotentialSettings& settings,
                  const ClothState& state, const Boundary& boundary, double dt,
                  const Minimiser& minimiser);

    /// Minimises from another start as well (such as a solver's result) and keeps the lower
    /// minimum: slack cloth folds in more than one way. Returns whether it was lower.
    bool try_from(Points start, const Minimiser& minimiser);

    /// @param x  |V| x 3 (m): positions at t + dt. A solver that gets below the minimiser scores a
    ///           negative gap, which says how much the reference left.
    StepScore score(const Points& x) const;

    const IncrementalPotential& potential() const { return m_potential; }
    const Points& guess() const { return m_guess; }            ///< projected extrapolation, |V| x 3
    const Points& minimum() const { return m_minimum; }        ///< |V| x 3
    double minimum_energy() const { return m_report.energy; }  ///< Emin (J)
    double guess_energy() const { return m_guess_energy; }     ///< (J)
    double still_energy() const { return m_still_energy; }  ///< of x_t, pins at their targets (J)
    const MinimiseReport& report() const { return m_report; }  ///< how well Emin is converged

 private:
    IncrementalPotential m_potential;
    Points m_guess, m_minimum;
    double m_guess_energy = 0.0, m_still_energy = 0.0;
    MinimiseReport m_report;
};

}  // namespace cloth
