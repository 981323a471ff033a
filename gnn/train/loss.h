#pragma once

#include <Eigen/SparseCore>
#include <string>

#include "gnn/physics/energy/incremental_potential.h"

namespace cloth {

/// How the energy of a prediction becomes a training loss.
enum class LossKind {
    energy,  ///< E itself (J), as the paper has it
    log,     ///< log(1 + (E - E_floor) / (M S^2 / dt^2)): scenes of all sizes weigh alike
    both,    ///< half the log of the energy gap, plus the log of the distance to a solver's answer
};

/// @throws ArgumentError unless `name` is energy, log or both
LossKind loss_named(const std::string& name);

/// The step that a prediction is scored on.
struct LossProblem {
    const IncrementalPotential* potential = nullptr;
    const Eigen::SparseMatrix<double>* laplacian = nullptr;  ///< cotangent, |V| x |V|
    const Boundary* boundary = nullptr;  ///< gravity and other accelerations; LossKind::log
    const Points* base = nullptr;        ///< |V| x 3 (m): the guess
    const Points* target = nullptr;      ///< |V| x 3 (m): what the solver found; LossKind::both
    double scale = 0.0;                  ///< of the network's output (m)
    /// Of log(e + 0.1) in the loss, e = |x - target| / |base - target| with the masses as weights:
    /// the error of low frequency, which energy and strain hardly see. 0: it is left out.
    double position_weight = 0.0;
};

struct LossValue {
    double value = 0.0;
    double energy = 0.0;  ///< of the prediction (J)
    double gap = 0.0;     ///< (E(x) - E(target)) / (E(base) - E(target)); LossKind::both
    double error = 0.0;   ///< e, where it has a weight
    Points gradient;      ///< |V| x 3: of the loss by the predicted positions (1/m)
};

/// The loss of predicted positions x (|V| x 3, m). The energy and its gradient are the reference
/// solver's own, in double precision: what is trained on is what is measured.
void evaluate_loss(LossKind kind, const LossProblem& problem, const Points& x, LossValue& loss);

/// Lower bound of E(x): inertia and gravity at their joint minimum, all other terms zero (J).
double energy_floor(const IncrementalPotential& potential, const Boundary& boundary,
                    const Points& base);

}  // namespace cloth
