#pragma once

#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/block_cholesky.h"
#include "gnn/physics/solver/quasi_newton.h"

namespace cloth {

struct NewtonSettings {
    int max_iterations = 60;  ///< 0 to 10000; each costs one Hessian and one factorisation
    double tolerance = 1e-4;  ///< stop at this residual, 0 to 1
    /// Below this residual the exact Hessian is tried first and the projected one only where the
    /// exact one is not positive definite, 0 to 1; 0: always projected.
    double exact_below = 0.1;
};

/// Minimises the incremental potential by Newton's method: sparse Cholesky factorisation, Armijo
/// line search, and four measures against what makes cloth hard.
///
/// - Compressed cloth has negative curvature: far from the minimum the Hessian is projected element
///   by element. Near it the projection slows convergence down to a linear rate, so the exact one
///   is tried there.
/// - Stiff cloth moves along curved valleys: when the line search has to shorten a step, a multiple
///   of the mean m / dt^2 joins the diagonal until full steps succeed again.
/// - Cloth that buckles starts from a saddle: full steps that fall on are doubled.
/// - Contact is a cubic wall of a few millimetres that the Hessian does not see from outside: a
///   trial step enters it no deeper than twice the present depth, and the rest is pushed out.
///
///     Newton newton(garment);
///     potential.begin_step(state, boundary, contacts, dt);
///     MinimiseReport report = newton.minimise(potential, x);
///
/// One object serves one thread at a time; the factorisation itself runs on all.
class Newton {
 public:
    /// @throws ArgumentError if a setting is out of range
    explicit Newton(const Garment& garment, const NewtonSettings& settings = {});

    const NewtonSettings& settings() const { return m_settings; }

    /// Lowers E from the given x (|V| x 3, m) on; rows of pinned vertices stay as they are. A
    /// potential of another number of vertices than the garment's, or one that is not finite at x,
    /// leaves x as it is (report.finite is false). E never rises. Never throws.
    /// @param at_x  E and its gradient at x, where they are known already; else null
    MinimiseReport minimise(const IncrementalPotential& potential, Points& x,
                            const PotentialValue* at_x = nullptr);

 private:
    bool iterate(const IncrementalPotential& potential, Points& x, MinimiseReport& report);
    void analyse();
    bool factorise(const IncrementalPotential& potential, const Points& x, double residual);
    bool find_direction(const IncrementalPotential& potential, const Points& x, double residual);
    double line_search(const IncrementalPotential& potential, const Points& x,
                       MinimiseReport& report);
    double widen(const IncrementalPotential& potential, const Points& x, double slope,
                 MinimiseReport& report);
    double try_step(const IncrementalPotential& potential, const Points& x, double step,
                    MinimiseReport& report);
    void adapt_shift(double step);
    double slope_along(const Points& gradient) const;

    NewtonSettings m_settings;
    Eigen::Index m_vertex_count;
    BlockCholesky m_cholesky;
    bool m_analysed = false;  ///< for this step's sparsity
    Eigen::SparseMatrix<double> m_hessian;
    double m_shift = 0.0;       ///< added to the diagonal, in units of the mean m / dt^2
    int m_projected_steps = 0;  ///< before the exact Hessian is tried again
    Points m_gradient, m_trial, m_trial_gradient;  ///< |V| x 3
    Points m_accepted, m_accepted_gradient;        ///< |V| x 3
    VectorX m_direction;                           ///< 3|V|
};

}  // namespace cloth
