#pragma once

#include <limits>
#include <optional>
#include <string>

#include "gnn/deadline.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/lbfgs_history.h"
#include "gnn/physics/solver/quasi_newton_matrix.h"

namespace cloth {

/// When the iterations of a minimisation end.
struct IterationLimits {
    int iterations = 10;  ///< at most, 0 to 10000; each costs one energy and, in contact, a solve
                          ///< with P more than contact_cg_iterations
    int least_iterations = 0;  ///< but not fewer than these, 0 to 10000
    double tolerance = 0.0;    ///< stop at this residual, 0 to 1e6; 0: run all iterations
    double least_gain = 0.0;   ///< or when MinimiseReport::gain is below this (m), 0 to 1; 0: never
    double most_residual = std::numeric_limits<double>::infinity();  ///< but not above this one

    /// What a simulation should use: ten iterations, and more, up to a hundred, for as long as five
    /// of them still gain 3 mm (gravity alone gains 11 mm in a frame of 1/30 s). The residual does
    /// not tell: that of a T-shirt in a jump is as high as that of stiff fabric that falls in slow
    /// motion, and only the latter needs the iterations.
    static IterationLimits controlled(int least = 10, int most = 100) {
        return {most, least, 0.0, 3e-3};
    }
    /// Those that are made whatever they gain.
    int least() const {
        return least_iterations > 0 && least_iterations < iterations ? least_iterations
                                                                     : iterations;
    }

    static IterationLimits exactly(int count) { return {count, 0, 0.0, 0.0}; }
    /// None at all: a step is where it starts, such as the network's answer.
    static IterationLimits none() { return exactly(0); }
    /// Until the residual is at the tolerance, at most so many.
    static IterationLimits until(double tolerance, int most) { return {most, 0, tolerance, 0.0}; }
};

/// @throws ArgumentError naming `owner` and the field that is out of range
void check(const IterationLimits& limits, const std::string& owner);

struct QuasiNewtonSettings : IterationLimits {
    int history = 8;  ///< pairs of the L-BFGS history, 0 to 50; 0: descent along -P^-1 g
    /// Iterations of a solve with P + contact blocks, 0 to 50; 0: contact stays out of the matrix.
    /// Affine displacements of the garment are deflated from them.
    int contact_cg_iterations = 7;
    /// Iterations of a solve with the FabricHessian of each point + contact blocks in place of P
    /// and the history, 0 to 200; 0: none. An iteration costs more, and stiff cloth, which P holds
    /// back where it could bend, needs few where the history needs many.
    int hessian_cg_iterations = 0;

    QuasiNewtonSettings() = default;
    QuasiNewtonSettings(const IterationLimits& limits) : IterationLimits(limits) {}
};

/// What one minimisation reached.
struct MinimiseReport {
    int iterations = 0;     ///< steps taken
    int evaluations = 0;    ///< energies (with gradients) computed
    double energy = 0.0;    ///< E(x) at the end (J)
    double residual = 0.0;  ///< |gradient| / force_scale() at the end, over the free vertices
    /// What the last five iterations gained, or with hessian_cg_iterations the last one, as a
    /// distance (m): dt sqrt(2 (decrease of E) / mass), by which the garment as a whole would have
    /// to be moved against its inertia for as much energy. None: there were fewer; 0: E could not
    /// be lowered any further.
    std::optional<double> gain;
    bool converged = false;    ///< the tolerance, or the least gain, was met
    bool out_of_time = false;  ///< the deadline ended it
    bool finite = true;        ///< false: the energy at the start was not finite, x is as it was
};

/// Minimises the incremental potential with one constant matrix P (see QuasiNewtonMatrix) in the
/// Hessian's place, an L-BFGS history that learns the difference, and a backtracking line search
/// (Liu, Bouaziz and Kavan 2017, "Quasi-Newton methods for real-time simulation of hyperelastic
/// materials", algorithm 1). Obstacles, which P does not know, come in by a ContactHessian. With
/// hessian_cg_iterations it is an inexact Newton method, which P preconditions.
///
///     QuasiNewton solver(garment, {});
///     potential.begin_step(state, boundary, contacts, dt);
///     starting_guess(garment, state, boundary, contacts, dt, contact_distance, x);
///     MinimiseReport report = solver.minimise(potential, x);
///
/// One object serves one thread at a time; after the first call nothing is allocated.
class QuasiNewton {
 public:
    /// @throws ArgumentError if a setting is out of range
    explicit QuasiNewton(const Garment& garment, QuasiNewtonSettings settings = {});

    const QuasiNewtonSettings& settings() const { return m_settings; }

    /// Lowers E from the given x (|V| x 3, m) on; rows of pinned vertices stay as they are. A
    /// potential of another fabric or time step than the last makes P anew; one of other vertices
    /// or pins is refused like a non-finite one (report.finite is false). Never throws.
    /// @param at_x  E and its gradient at x, where they are known already; else null
    MinimiseReport minimise(const IncrementalPotential& potential, Points& x,
                            const PotentialValue* at_x = nullptr);
    /// The same within other limits than the settings', the first iteration whatever the deadline.
    /// @param for_more  where there is a deadline, also one of iterations beyond limits.least()
    MinimiseReport minimise(const IncrementalPotential& potential, Points& x,
                            const IterationLimits& limits, const PotentialValue* at_x = nullptr,
                            const Deadline& deadline = {}, const Deadline& for_more = {});

    /// Makes P for a fabric and a time step (s) ahead of time; those of the last 16 are kept.
    /// False: not positive definite.
    bool prepare(const Garment& garment, double dt);

    /// out = P^-1 gradient (|V| x 3, m), zero at pinned vertices. Needs `prepare` or `minimise`
    /// first.
    void precondition(const Points& gradient, Points& out) const;

    /// Whether minimisations go on with the history and the deflated fields of the one before,
    /// which suit a step of the same length that follows it at once. By default they do not.
    void set_continued(bool continued) { m_continued = continued; }
    /// Whether minimisations take the Hessian where settings have hessian_cg_iterations. By default
    /// they do.
    void set_by_hessian(bool by_hessian) { m_by_hessian = by_hessian; }

    const QuasiNewtonMatrix& matrix() const { return m_matrix; }

 private:
    bool start(const IncrementalPotential& potential, const Points& x, const PotentialValue* at_x,
               MinimiseReport& report);
    bool iterate(const IncrementalPotential& potential, Points& x, MinimiseReport& report);
    void find_direction(const IncrementalPotential& potential, const Points& x);
    bool line_search(const IncrementalPotential& potential, Points& x, MinimiseReport& report);
    void update_residual(const IncrementalPotential& potential, MinimiseReport& report) const;
    int hessian_cg_iterations() const {
        return m_by_hessian ? m_settings.hessian_cg_iterations : 0;
    }

    QuasiNewtonSettings m_settings;
    QuasiNewtonMatrix m_matrix;
    ContactHessian m_contacts;
    LbfgsHistory m_history;
    bool m_continued = false, m_by_hessian = true;
    Points m_all_gradient, m_trial;                                 ///< |V| x 3
    Points m_gradient, m_next_gradient, m_direction, m_right_side;  ///< free vertices (n x 3)
    mutable Points m_gathered, m_preconditioned;                    ///< n x 3
};

}  // namespace cloth
