#include "gnn/physics/solver/newton.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "data/core/check_range.h"
#include "gnn/physics/solver/goal_hessian.h"

namespace cloth {

namespace {

constexpr double armijo = 1e-4;         // share of the predicted decrease that a step must bring
constexpr int max_halvings = 20;        // of one line search
constexpr int max_factorisations = 30;  // of one iteration, each with four times the shift
constexpr double shift_factor = 2.0;    // by which the shift follows the line search
constexpr int retry_exact_after = 2;    // projected steps after the exact Hessian was indefinite
constexpr double still_falling = 0.3;   // share of the slope that makes a full step worth widening
constexpr int max_widenings = 6;        // of one line search
constexpr double entry_depth = 5e-5;    // depth (m) at which a trial step may enter a contact

Eigen::Map<const VectorX> flat(const Points& points) {
    return {points.data(), points.size()};
}

/// Pushes vertices of `trial` that went deeper into a contact than twice their depth at `x` back to
/// that depth.
void limit_entry(const IncrementalPotential& potential, const Points& x, Points& trial) {
    const SurfaceContacts& contacts = potential.contacts();
    const double eps = potential.settings().contact_distance;
    const Eigen::Index count = static_cast<Eigen::Index>(contacts.obstacle.size());
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!contacts.has(i) || potential.garment().is_pinned()[static_cast<size_t>(i)]) continue;
        const Eigen::RowVector3d normal = contacts.normal1.row(i), point = contacts.point1.row(i);
        const double depth = eps - normal.dot(x.row(i) - point);
        const double trial_depth = eps - normal.dot(trial.row(i) - point);
        const double allowed = std::max(2.0 * depth, entry_depth);
        if (trial_depth > allowed) trial.row(i) += (trial_depth - allowed) * normal;
    }
    potential.self_contact().limit_entry(x, trial);
    for (const VertexGoal& goal : potential.goals().limits())
        limit_excess(goal, allowed_excess(goal, x.row(goal.vertex)), trial);
}

/// The next step length after a trial at `step` with energy `trial`: the minimum of the parabola
/// through what is known, kept within a tenth and a half of the step.
double shorten(double step, double slope, double energy, double trial) {
    const double curvature = 2.0 * (trial - energy - slope * step);
    const double minimum = -slope * step * step / curvature;
    if (!std::isfinite(minimum)) return 0.5 * step;
    return std::clamp(minimum, 0.1 * step, 0.5 * step);
}

/// Below this (J) a difference of energies is rounding.
double rounding(double energy) {
    return 1e-13 * std::fabs(energy) + 1e-16;
}

void validate(const NewtonSettings& settings) {
    check_range("NewtonSettings.max_iterations", settings.max_iterations, 0, 10000);
    check_range("NewtonSettings.tolerance", settings.tolerance, 0.0, 1.0);
    check_range("NewtonSettings.exact_below", settings.exact_below, 0.0, 1.0);
}

}  // namespace

Newton::Newton(const Garment& garment, const NewtonSettings& settings)
    : m_settings(settings), m_vertex_count(garment.vertex_count()) {
    validate(settings);
}

MinimiseReport Newton::minimise(const IncrementalPotential& potential, Points& x,
                                const PotentialValue* at_x) {
    MinimiseReport report;
    report.finite = false;
    if (potential.garment().vertex_count() != m_vertex_count || x.rows() != m_vertex_count)
        return report;
    if (at_x) {
        report.energy = at_x->energy;
        m_gradient = at_x->gradient;
    } else {
        report.energy = potential.value_gradient(x, m_gradient);
        report.evaluations = 1;
    }
    report.residual = m_gradient.norm() / potential.force_scale();
    report.finite = std::isfinite(report.energy) && std::isfinite(report.residual);
    m_shift = 0.0;
    m_projected_steps = 0;
    if (potential.self_contact().on()) m_analysed = false;
    while (report.finite && report.iterations < m_settings.max_iterations &&
           report.residual > m_settings.tolerance)
        if (!iterate(potential, x, report)) break;
    report.converged = report.finite && report.residual <= m_settings.tolerance;
    return report;
}

/// One step; false: none lowers the energy any more.
bool Newton::iterate(const IncrementalPotential& potential, Points& x, MinimiseReport& report) {
    if (!find_direction(potential, x, report.residual)) return false;
    double step = line_search(potential, x, report);
    if (step == 0.0) {  // once more along a direction closer to steepest descent
        m_shift = std::max(100.0, 100.0 * m_shift);
        m_projected_steps = retry_exact_after;
        if (!find_direction(potential, x, report.residual)) return false;
        step = line_search(potential, x, report);
        if (step == 0.0) return false;
    }
    adapt_shift(step);
    x.swap(m_trial);
    m_gradient.swap(m_trial_gradient);
    report.residual = m_gradient.norm() / potential.force_scale();
    report.iterations += 1;
    return true;
}

/// Self-contact gives the Hessian another sparsity in each step.
void Newton::analyse() {
    if (m_analysed && m_cholesky.is_analysed_for(m_hessian)) return;
    m_cholesky.analyse(m_hessian);
    m_analysed = true;
}

bool Newton::factorise(const IncrementalPotential& potential, const Points& x, double residual) {
    const double dt = potential.inertial_dt();
    const double unit = potential.garment().masses().mean() / (dt * dt);
    const bool try_exact = residual < m_settings.exact_below && m_projected_steps == 0;
    m_projected_steps = std::max(0, m_projected_steps - 1);
    if (try_exact) {
        potential.hessian(x, m_hessian, HessianKind::exact);
        analyse();
        if (m_cholesky.factorise(m_hessian, m_shift * unit)) return true;
        m_projected_steps = retry_exact_after;
    }
    potential.hessian(x, m_hessian, HessianKind::projected);
    analyse();
    double shift = m_shift;  // rounding alone can make the projected Hessian fail
    for (int k = 0; k < max_factorisations; ++k) {
        if (m_cholesky.factorise(m_hessian, shift * unit)) return true;
        shift = std::max(1.0, 4.0 * shift);
    }
    return false;
}

bool Newton::find_direction(const IncrementalPotential& potential, const Points& x,
                            double residual) {
    if (!factorise(potential, x, residual)) return false;
    m_direction = -flat(m_gradient);
    m_cholesky.solve(m_direction);
    for (int pin : potential.garment().pins()) m_direction.segment<3>(3 * pin).setZero();
    return m_direction.allFinite() && slope_along(m_gradient) < 0.0;
}

double Newton::slope_along(const Points& gradient) const {
    return flat(gradient).dot(m_direction);
}

/// Sets m_trial to x + step * direction and returns its energy; its gradient is in
/// m_trial_gradient.
double Newton::try_step(const IncrementalPotential& potential, const Points& x, double step,
                        MinimiseReport& report) {
    m_trial = x;
    Eigen::Map<VectorX>(m_trial.data(), m_trial.size()) += step * m_direction;
    limit_entry(potential, x, m_trial);
    report.evaluations += 1;
    return potential.value_gradient(m_trial, m_trial_gradient);
}

/// Leaves the accepted position in m_trial, its gradient in m_trial_gradient and its energy in the
/// report. Returns the step length, 0: none was found. Where the decrease is below rounding, a
/// smaller gradient counts instead.
double Newton::line_search(const IncrementalPotential& potential, const Points& x,
                           MinimiseReport& report) {
    const double slope = slope_along(m_gradient);
    double step = 1.0;
    for (int k = 0; k < max_halvings; ++k) {
        const double energy = try_step(potential, x, step, report);
        const bool decreases = energy <= report.energy + armijo * step * slope;
        const bool flattens = std::fabs(energy - report.energy) <= rounding(report.energy) &&
                              m_trial_gradient.norm() < m_gradient.norm();
        if ((decreases || flattens) && m_trial_gradient.allFinite()) {
            report.energy = energy;
            if (k == 0 && decreases) return widen(potential, x, slope, report);
            return step;
        }
        step = shorten(step, slope, report.energy, energy);
    }
    return 0.0;
}

/// Doubles an accepted full step as long as the energy falls at nearly the old slope: where the
/// Hessian was projected, the minimum of cloth that buckles is much farther than the model says.
double Newton::widen(const IncrementalPotential& potential, const Points& x, double slope,
                     MinimiseReport& report) {
    double step = 1.0;
    for (int k = 0; k < max_widenings; ++k) {
        if (slope_along(m_trial_gradient) > still_falling * slope) break;
        m_accepted.swap(m_trial);
        m_accepted_gradient.swap(m_trial_gradient);
        const double energy = try_step(potential, x, 2.0 * step, report);
        if (!(energy < report.energy) || !m_trial_gradient.allFinite()) {
            m_accepted.swap(m_trial);
            m_accepted_gradient.swap(m_trial_gradient);
            break;
        }
        report.energy = energy;
        step *= 2.0;
    }
    return step;
}

void Newton::adapt_shift(double step) {
    if (step < 0.5)
        m_shift = std::max(1.0, shift_factor * m_shift);
    else if (step >= 1.0)
        m_shift = m_shift / shift_factor < 0.3 ? 0.0 : m_shift / shift_factor;
}

}  // namespace cloth
