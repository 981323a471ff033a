#include "gnn/train/loss.h"

#include <algorithm>
#include <cmath>

#include "data/core/errors.h"

namespace cloth {

LossKind loss_named(const std::string& name) {
    if (name == "energy") return LossKind::energy;
    if (name == "log") return LossKind::log;
    if (name == "both") return LossKind::both;
    throw ArgumentError("loss '" + name + "'", "is not known", "use energy, log or both");
}

double energy_floor(const IncrementalPotential& potential, const Boundary& boundary,
                    const Points& base) {
    const Garment& garment = potential.garment();
    const double dt = potential.dt();
    Points fallen = potential.inertial_target();
    fallen.rowwise() += dt * dt * boundary.gravity.transpose();
    if (boundary.accelerations.rows() == fallen.rows()) fallen += dt * dt * boundary.accelerations;
    for (int pin : garment.pins()) fallen.row(pin) = base.row(pin);
    const EnergyTerms terms = potential.terms(fallen);
    return terms.gravity + terms.inertia;
}

/// Value and gradient of log(1 + (E - floor) / unit).
static void take_log(const LossProblem& problem, LossValue& loss) {
    const IncrementalPotential& potential = *problem.potential;
    const double unit = potential.garment().masses().sum() * problem.scale * problem.scale /
                        (potential.dt() * potential.dt());
    const double excess =
        std::max(0.0, loss.energy - energy_floor(potential, *problem.boundary, *problem.base)) /
        unit;
    loss.value = std::log1p(excess);
    loss.gradient /= unit * (1.0 + excess);
}

/// P d with P = M / dt^2 + (2 mu + lambda) L, the quasi-Newton solver's matrix.
static Points apply_metric(const LossProblem& problem, const Points& d) {
    const IncrementalPotential& potential = *problem.potential;
    const Garment& garment = potential.garment();
    const double dt = potential.dt();
    Points out = garment.fabric().longitudinal() * ((*problem.laplacian) * d);
    for (Eigen::Index i = 0; i < d.rows(); ++i)
        if (garment.is_pinned()[static_cast<size_t>(i)])
            out.row(i).setZero();
        else
            out.row(i) += garment.masses()[i] / (dt * dt) * d.row(i);
    return out;
}

/// 0.5 log(gap + 0.03) + log(error + 0.1), error = |x - target|_P / |base - target|_P.
static void take_both(const LossProblem& problem, const Points& x, LossValue& loss) {
    const IncrementalPotential& potential = *problem.potential;
    const double least = potential.value(*problem.target);
    const double unit = std::max(potential.value(*problem.base) - least, 1e-12);
    loss.gap = (loss.energy - least) / unit;
    const double gap = std::max(0.0, loss.gap);
    const Points d = x - *problem.target, d_base = *problem.base - *problem.target;
    const Points p_d = apply_metric(problem, d);
    const double base_error =
        std::max(d_base.cwiseProduct(apply_metric(problem, d_base)).sum(), 1e-18);
    const double error =
        std::sqrt(std::max(d.cwiseProduct(p_d).sum(), 1e-12 * base_error) / base_error);
    loss.value = 0.5 * std::log(gap + 0.03) + std::log(error + 0.1);
    loss.gradient *= 0.5 / (unit * (gap + 0.03));
    loss.gradient += p_d / (base_error * error * (error + 0.1));
}

static void add_position(const LossProblem& problem, const Points& x, LossValue& loss) {
    const Garment& garment = problem.potential->garment();
    const auto weighted = [&](Points d) {
        for (Eigen::Index i = 0; i < d.rows(); ++i)
            d.row(i) *= garment.is_pinned()[static_cast<size_t>(i)] ? 0.0 : garment.masses()[i];
        return d;
    };
    const Points d = x - *problem.target, d_base = *problem.base - *problem.target;
    const Points m_d = weighted(d);
    const double base_error = std::max(d_base.cwiseProduct(weighted(d_base)).sum(), 1e-18);
    loss.error = std::sqrt(std::max(d.cwiseProduct(m_d).sum(), 1e-12 * base_error) / base_error);
    loss.value += problem.position_weight * std::log(loss.error + 0.1);
    loss.gradient += problem.position_weight * m_d / (base_error * loss.error * (loss.error + 0.1));
}

void evaluate_loss(LossKind kind, const LossProblem& problem, const Points& x, LossValue& loss) {
    loss.energy = problem.potential->value_gradient(x, loss.gradient);
    loss.value = loss.energy;
    if (kind == LossKind::log) take_log(problem, loss);
    if (kind == LossKind::both) take_both(problem, x, loss);
    if (problem.position_weight > 0.0) add_position(problem, x, loss);
}

}  // namespace cloth
