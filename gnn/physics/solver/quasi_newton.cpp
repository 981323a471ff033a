#include "gnn/physics/solver/quasi_newton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "data/core/check_range.h"
#include "gnn/physics/solver/dot.h"

namespace cloth {
namespace {

constexpr double sufficient_decrease = 1e-4;  // of Armijo's rule
constexpr int max_backtracks = 20;

/// The energies of the last iterations, and what became of them as a distance.
class Gain {
 public:
    /// @param span  iterations, 1 to 5
    Gain(double dt, double mass, int span)
        : m_scale(dt * std::sqrt(2.0 / mass)), m_span(static_cast<size_t>(span)) {}

    /// @return  see MinimiseReport::gain (m)
    std::optional<double> after(double energy) {
        double& oldest = m_energies[m_count++ % m_span];
        const double before = std::exchange(oldest, energy);
        if (m_count <= m_span) return std::nullopt;
        return m_scale * std::sqrt(std::max(0.0, before - energy));
    }

 private:
    double m_scale;
    size_t m_span, m_count = 0;
    std::array<double, 5> m_energies = {};
};

// Minimum of the parabola through E(0), its slope and E(step), kept within a tenth and a half.
double shorter_step(double step, double energy, double slope, double trial_energy) {
    const double parabola = -0.5 * slope * step * step / (trial_energy - energy - slope * step);
    return std::isfinite(parabola) ? std::clamp(parabola, 0.1 * step, 0.5 * step) : 0.1 * step;
}

}  // namespace

void check(const IterationLimits& limits, const std::string& owner) {
    check_range(owner + ".iterations", limits.iterations, 0, 10000);
    check_range(owner + ".least_iterations", limits.least_iterations, 0, 10000);
    check_range(owner + ".tolerance", limits.tolerance, 0.0, 1e6);
    check_range(owner + ".least_gain", limits.least_gain, 0.0, 1.0);
    check_range(owner + ".most_residual", limits.most_residual, 0.0,
                std::numeric_limits<double>::infinity());
}

QuasiNewton::QuasiNewton(const Garment& garment, QuasiNewtonSettings settings)
    : m_settings(settings), m_matrix(garment) {
    check(settings, "QuasiNewtonSettings");
    check_range("QuasiNewtonSettings.history", settings.history, 0, 50);
    check_range("QuasiNewtonSettings.contact_cg_iterations", settings.contact_cg_iterations, 0, 50);
    check_range("QuasiNewtonSettings.hessian_cg_iterations", settings.hessian_cg_iterations, 0,
                200);
    const Eigen::Index free = m_matrix.free_count();
    m_history.allocate(settings.history, free);
    for (Points* array : {&m_gradient, &m_next_gradient, &m_direction, &m_right_side, &m_gathered,
                          &m_preconditioned})
        array->resize(free, 3);
}

bool QuasiNewton::prepare(const Garment& garment, double dt) {
    if (!m_matrix.prepare(garment, dt)) return false;
    if (m_settings.hessian_cg_iterations > 0) m_matrix.prepare_hessian(garment);
    return true;
}

void QuasiNewton::precondition(const Points& gradient, Points& out) const {
    m_matrix.gather(gradient, m_gathered);
    m_matrix.solve(m_gathered, m_preconditioned);
    m_matrix.scatter(m_preconditioned, out);
}

MinimiseReport QuasiNewton::minimise(const IncrementalPotential& potential, Points& x,
                                     const PotentialValue* at_x) {
    return minimise(potential, x, m_settings, at_x);
}

MinimiseReport QuasiNewton::minimise(const IncrementalPotential& potential, Points& x,
                                     const IterationLimits& limits, const PotentialValue* at_x,
                                     const Deadline& deadline, const Deadline& for_more) {
    MinimiseReport report;
    if (!start(potential, x, at_x, report)) {
        report.finite = false;
        report.residual = std::numeric_limits<double>::quiet_NaN();
        return report;
    }
    const auto met = [&] {
        return report.residual <= limits.most_residual &&
               (report.residual <= limits.tolerance ||
                (report.gain && *report.gain < limits.least_gain));
    };
    Gain gain(potential.inertial_dt(), potential.garment().masses().sum(),
              hessian_cg_iterations() > 0 ? 1 : 5);
    gain.after(report.energy);
    double longest = 0.0, left = deadline.left();  // ms
    while (report.iterations < limits.iterations) {
        if (met() && report.iterations >= limits.least_iterations) break;
        if (report.iterations > 0 && deadline.is_set()) {
            const double now = deadline.left();
            longest = std::max(longest, left - now);
            left = now;
            const bool more = report.iterations >= limits.least();
            report.out_of_time = (more ? std::min(left, for_more.left()) : left) < longest;
            if (report.out_of_time) break;
        }
        if (!iterate(potential, x, report)) {
            report.gain = 0.0;
            break;
        }
        report.gain = gain.after(report.energy);
    }
    report.converged = met();
    return report;
}

bool QuasiNewton::start(const IncrementalPotential& potential, const Points& x,
                        const PotentialValue* at_x, MinimiseReport& report) {
    const Garment& garment = potential.garment();
    if (!m_matrix.fits(garment) || x.rows() != garment.vertex_count() || !x.allFinite())
        return false;
    if (!m_matrix.prepare(garment, potential.inertial_dt())) return false;
    if (!m_continued) m_history.clear();
    m_contacts.begin_step(potential, m_matrix.row_of());
    if (hessian_cg_iterations() == 0 && m_settings.contact_cg_iterations > 0 &&
        m_contacts.active() && !(m_continued && m_matrix.deflate_as_before()))
        m_matrix.deflate(x);
    if (at_x) {
        report.energy = at_x->energy;
        m_matrix.gather(at_x->gradient, m_gradient);
    } else {
        report.energy = potential.value_gradient(x, m_all_gradient);
        report.evaluations = 1;
        m_matrix.gather(m_all_gradient, m_gradient);
    }
    update_residual(potential, report);
    return std::isfinite(report.energy) && m_gradient.allFinite();
}

void QuasiNewton::update_residual(const IncrementalPotential& potential,
                                  MinimiseReport& report) const {
    const double scale = std::max(potential.force_scale(), std::numeric_limits<double>::min());
    report.residual = m_gradient.norm() / scale;
}

// One step; false where E cannot be lowered any further in double precision.
bool QuasiNewton::iterate(const IncrementalPotential& potential, Points& x,
                          MinimiseReport& report) {
    find_direction(potential, x);
    if (!line_search(potential, x, report)) {
        if (m_history.empty()) return false;
        m_history.clear();
        find_direction(potential, x);
        if (!line_search(potential, x, report)) return false;
    }
    ++report.iterations;
    if (hessian_cg_iterations() == 0) m_history.push(m_direction, m_gradient, m_next_gradient);
    m_gradient.swap(m_next_gradient);
    update_residual(potential, report);
    return true;
}

void QuasiNewton::find_direction(const IncrementalPotential& potential, const Points& x) {
    m_right_side = -m_gradient;
    m_contacts.linearise(potential, x);
    if (hessian_cg_iterations() > 0) {
        m_matrix.solve(potential.garment(), x, m_right_side, m_contacts, hessian_cg_iterations(),
                       m_direction);
        return;
    }
    m_history.first_loop(m_right_side);
    if (m_settings.contact_cg_iterations > 0 && m_contacts.active())
        m_matrix.solve(m_right_side, m_contacts, m_settings.contact_cg_iterations, m_direction);
    else
        m_matrix.solve(m_right_side, m_direction);
    m_history.second_loop(m_direction);
}

// Moves x and leaves the step taken in m_direction, or leaves x as it is.
bool QuasiNewton::line_search(const IncrementalPotential& potential, Points& x,
                              MinimiseReport& report) {
    const double slope = dot(m_gradient, m_direction);
    // Below this the decrease is lost in the rounding of E.
    const double resolution = std::numeric_limits<double>::epsilon() * std::abs(report.energy);
    if (!(-slope > resolution)) return false;
    double step = 1.0;
    for (int k = 0; k < max_backtracks; ++k) {
        m_trial = x;
        m_matrix.add_scaled(step, m_direction, m_trial);
        m_contacts.limit_depth(m_trial);
        const double energy = potential.value_gradient(m_trial, m_all_gradient);
        ++report.evaluations;
        if (energy <= report.energy + sufficient_decrease * step * slope) {
            m_matrix.gather(m_all_gradient, m_next_gradient);
            if (m_next_gradient.allFinite()) {
                m_matrix.gather_difference(m_trial, x, m_direction);
                x.swap(m_trial);
                report.energy = energy;
                return true;
            }
        }
        step = shorter_step(step, report.energy, slope, energy);
    }
    return false;
}

}  // namespace cloth
