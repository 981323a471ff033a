#include "gnn/physics/stepper/step_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "collision/response/resolve.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {
namespace {

constexpr int most_iterations = 200;  // towards a residual that is asked for
// What moves no faster is at rest, or soon will be: few iterations in small steps would leave it
// trembling, as many in one step do not.
constexpr double rest_speed = 0.1;  // m/s

constexpr int newton_steps = 4;             // in place of many iterations, at most
constexpr double least_newton_gain = 1e-4;  // m: one that gains less is the last
constexpr int iterations_at_goals = 2;      // after Newton's step
constexpr double stiff_wave_speed = 32.0;   // m/s, along the cloth; real cotton has 170, soft 15

bool is_stiff(const Fabric& fabric) {
    return fabric.longitudinal() > stiff_wave_speed * stiff_wave_speed * fabric.density;
}

/// What they mean for this fabric, checked.
StepSettings settings_for(StepSettings settings, const Fabric& fabric, bool has_start) {
    check_range("StepSettings.contact_updates", settings.contact_updates, 0, 10);
    check_range("StepSettings.safety_distance", settings.safety_distance, 0.0, 1e-3);
    check_range("StepSettings.small_step_rate", settings.small_step_rate, 0.0, 1e4);
    check_range("StepSettings.stiff_cg_iterations", settings.stiff_cg_iterations, 0, 200);
    check(settings.quasi_newton, "QuasiNewtonSettings");  // before they are replaced
    const bool by_newton = settings.small_step_rate > 0.0 && settings.stiff_cg_iterations > 0;
    if (by_newton && is_stiff(fabric) && !has_start) {
        settings.quasi_newton.iterations = 1;
        settings.quasi_newton.hessian_cg_iterations = settings.stiff_cg_iterations;
    }
    return settings;
}

/// "" of limits that control the error.
std::string suffix_of(const IterationLimits& limits, char mark) {
    if (limits.least_gain > 0.0) return "";
    char text[32];
    if (limits.tolerance > 0.0)
        std::snprintf(text, sizeof text, "%c%.0e", mark, limits.tolerance);
    else
        std::snprintf(text, sizeof text, "%c%d", mark, limits.iterations);
    return text;
}

bool is_moving(const ClothState& state) {
    return state.v.rowwise().squaredNorm().maxCoeff() > rest_speed * rest_speed;
}

}  // namespace

StepSolver::StepSolver(const Garment& garment, const StepSettings& settings,
                       std::shared_ptr<StepStart> start, std::shared_ptr<ObstacleTrees> trees)
    : m_garment(&garment),
      m_settings(settings_for(settings, garment.fabric(), start != nullptr)),
      m_start(std::move(start)),
      m_potential(garment, settings.potential),
      m_time(settings.potential.integrator),
      m_quasi_newton(garment, m_settings.quasi_newton),
      m_newton(garment, settings.newton),
      m_proximity(settings.proximity, std::move(trees)),
      m_ridges(garment),
      m_projection(garment),
      m_goals(garment),
      m_self_contact(garment, settings.potential.self_contact) {
}

std::string StepSolver::name() const {
    const IterationLimits& limits = m_settings.quasi_newton;
    const double rate = m_settings.small_step_rate;
    const std::string small = rate > 0.0 ? "s" + std::to_string(std::lround(rate)) : "";
    if (m_start) return m_start->name() + suffix_of(limits, '+') + small;
    if (m_settings.minimiser == MinimiserKind::newton) return "reference";
    std::string name = "quasi-newton";
    if (limits.tolerance == 0.0) name += suffix_of(limits, '-');
    name += small;
    if (const int cg = m_settings.quasi_newton.hessian_cg_iterations; cg > 0)
        name += "-cg" + std::to_string(cg);
    if (m_settings.potential.integrator == Integrator::bdf2) name += "-bdf2";
    return name;
}

void StepSolver::prepare(double dt) {
    if (m_settings.minimiser == MinimiserKind::newton || !(dt > 0.0)) return;
    m_quasi_newton.prepare(*m_garment, dt);
    if (m_settings.potential.integrator == Integrator::bdf2)
        m_quasi_newton.prepare(*m_garment, bdf2_inertial_dt(dt));
}

/// By what was set for the time being.
IterationLimits StepSolver::adjusted(IterationLimits limits) const {
    if (!std::isinf(m_most_residual)) {
        const bool of_a_number = limits.tolerance == 0.0 && limits.least_gain == 0.0;
        if (of_a_number) {
            limits.least_iterations = limits.iterations;
            limits.tolerance = m_most_residual;
        }
        limits.most_residual = m_most_residual;
        limits.iterations = std::max(limits.iterations, most_iterations);
    }
    const int most = std::max(1, m_max_iterations / m_parts);
    limits.iterations = std::min(limits.iterations, most);
    limits.least_iterations = std::min(limits.least_iterations, most);
    return limits;
}

/// Where settings ask for small steps by Newton's method, of which one step does what many
/// iterations do: more of them cost much and gain little.
IterationLimits StepSolver::enough(const IterationLimits& limits) const {
    const bool by_newton =
        m_settings.small_step_rate > 0.0 && m_settings.quasi_newton.hessian_cg_iterations > 0;
    if (!by_newton) return limits;
    IterationLimits few = IterationLimits::exactly(std::min(newton_steps, limits.iterations));
    if (std::isinf(m_most_residual)) {
        few.least_iterations = 1;
        few.least_gain = least_newton_gain;
    }
    return few;
}

/// After small steps no more than all of them took: the most of it is done, and converged steps
/// would stand out by their time alone.
IterationLimits StepSolver::for_correction(const IterationLimits& limits, double dt) const {
    IterationLimits few = enough(limits);
    if (const int count = small_steps(dt); count > 1)
        few.iterations = std::min(few.iterations, count * m_settings.quasi_newton.iterations);
    return few;
}

StepReport StepSolver::whole(const Boundary& boundary, double dt, ClothState& state) {
    IterationLimits limits = m_settings.quasi_newton;
    const int count = small_steps(dt);
    const bool by_history = m_settings.quasi_newton.hessian_cg_iterations == 0;
    const bool rests = m_settings.small_step_rate > 0.0 && by_history && !is_moving(state);
    if (count > 1 || rests) {
        const IterationLimits one = IterationLimits::controlled();
        limits = IterationLimits::controlled(std::max(one.least(), count * limits.iterations),
                                             std::max(one.iterations, count * limits.iterations));
    }
    return solve(boundary, dt, start_for(dt), enough(limits), 1, state);
}

StepReport StepSolver::in_small_steps(int count, const Boundary& boundary, double dt, From from,
                                      ClothState& state) {
    return solve(boundary, dt, from == From::start ? m_start.get() : nullptr,
                 m_settings.quasi_newton, count, state);
}

double StepSolver::fixed_dt() const {
    const double rate = m_settings.small_step_rate;
    const bool for_small_steps = m_start && rate > 0.0 && start_for(1.0 / rate);
    return !m_start || for_small_steps ? 0.0 : m_start->fixed_dt();
}

StepStart* StepSolver::start_for(double dt) const {
    constexpr double same = 1e-3;  // callers' time steps are floats
    if (!m_start) return nullptr;
    const double made_for = m_start->fixed_dt();
    const bool fits = made_for == 0.0 || std::abs(dt - made_for) < same * made_for;
    return fits ? m_start.get() : nullptr;
}

int StepSolver::worthwhile_iterations() const {
    return std::clamp(m_settings.quasi_newton.iterations, 1, 2);
}

/// Where few iterations are allowed they are not spread so thinly that the cloth gets softer.
int StepSolver::small_steps(double dt) const {
    constexpr double rounding = 1e-3;  // callers' time steps are floats
    constexpr int most = 64;
    if (m_settings.minimiser == MinimiserKind::newton) return 1;
    const double asked = std::ceil(m_settings.small_step_rate * dt - rounding);
    const int allowed = std::min(most, m_max_iterations / worthwhile_iterations());
    return asked < allowed ? std::max(1, static_cast<int>(asked)) : std::max(1, allowed);
}

int StepSolver::small_steps(double dt, const ClothState& state) const {
    const int count = std::isinf(m_most_residual) ? small_steps(dt) : 1;
    return count > 1 && is_moving(state) ? count : 1;
}

int StepSolver::small_steps_of_part(double dt, const ClothState& state) const {
    const bool by_history = m_settings.minimiser == MinimiserKind::quasi_newton &&
                            m_settings.quasi_newton.hessian_cg_iterations == 0;
    const bool has_few = m_settings.small_step_rate > 0.0 && std::isinf(m_most_residual);
    // Layers that are thrown about come apart with many iterations only.
    if (!by_history || !has_few || m_self_contact.on() || !is_moving(state)) return 0;
    const int count = small_steps(dt);
    return !m_start || start_for(dt / count) ? count : 0;
}

/// Many iterations of the history are cheaper than few steps of Newton's, and nearer where goals
/// are limited.
StepReport StepSolver::part(const Boundary& boundary, double dt, const IterationLimits& limits,
                            ClothState& state) {
    m_quasi_newton.set_by_hessian(limits.iterations <= newton_steps);
    const StepReport report = solve(boundary, dt, nullptr, limits, 1, state);
    m_quasi_newton.set_by_hessian(true);
    return report;
}

StepReport StepSolver::solve(const Boundary& boundary, double dt, StepStart* start,
                             const IterationLimits& limits, int parts, ClothState& state) {
    StepReport report;
    Stopwatch watch;
    for (int round = 0; round <= m_settings.contact_updates; ++round) {
        const bool first = round == 0;
        find_contacts(boundary, first ? state.x : m_x, first ? StepEnd::start : StepEnd::end);
        report.times.proximity += watch.lap();
        const Start from = first ? Start::guess : Start::here;
        if (!run(boundary, dt, first ? start : nullptr, from, limits, parts, state, report))
            return StepReport::failed();
        report.times.solve += watch.lap();
        if (boundary.obstacles.empty() || report.out_of_time) break;
    }
    report.times.solve -= report.times.features;
    return finish(boundary, dt, state, report);
}

StepReport StepSolver::correct(const Boundary& boundary, double dt,
                               const TunnellingDetector* through, const IterationLimits& limits,
                               ClothState& state) {
    if (m_x.rows() != state.x.rows() || boundary.obstacles.empty()) return StepReport::failed();
    StepReport report;
    Stopwatch watch;
    find_contacts(boundary, m_x, StepEnd::end);
    if (through) through->hold_where_they_went_in(m_contacts, m_x);
    report.times.proximity = watch.lap();
    if (!run(boundary, dt, nullptr, Start::here, for_correction(limits, dt), 1, state, report))
        return StepReport::failed();
    report.times.solve = watch.lap();
    return finish(boundary, dt, state, report);
}

bool StepSolver::go_on_from(Points& x, StepEnd contacts, const Boundary& boundary, double dt,
                            const ClothState& state, StepReport& report) {
    Stopwatch watch;
    m_x = x;
    find_contacts(boundary, contacts == StepEnd::start ? state.x : x, contacts);
    report.times.proximity += watch.lap();
    const double features = report.times.features;
    const bool finite = run(boundary, dt, start_for(dt), Start::outside, m_settings.quasi_newton, 1,
                            state, report) &&
                        m_x.allFinite();
    report.times.solve += watch.lap() - (report.times.features - features);
    if (finite) x = m_x;
    return finite;
}

/// Minimises a step in so many parts, from the guess or from m_x, with m_contacts. Leaves the end
/// in m_x and m_last, the state before the last part.
bool StepSolver::run(const Boundary& boundary, double dt, StepStart* start, Start from,
                     const IterationLimits& limits, int parts, const ClothState& state,
                     StepReport& report) {
    m_last = state;
    m_last_dt = dt / parts;
    m_parts = parts;
    if (parts > 1) m_next_start.resize(0, 3);
    const std::vector<char>& unrepelled = m_self_contact.begin_step(state.x, boundary.overlapped);
    if (parts > 1) return run_small_steps(boundary, dt, start, limits, unrepelled, report);
    begin(boundary, m_contacts, dt, unrepelled);
    return minimise_part(boundary, m_contacts, start, from, limits, report);
}

/// From m_last, which goes on from part to part.
bool StepSolver::run_small_steps(const Boundary& boundary, double dt, StepStart* start,
                                 const IterationLimits& limits, const std::vector<char>& unrepelled,
                                 StepReport& report) {
    const int parts = m_parts;
    StepStart* const of_each = start ? start_for(m_last_dt) : nullptr;
    bool predicted = start && !of_each && start_for(dt) &&
                     predict_acceleration(boundary, dt, *start, unrepelled, report);
    bool rejected = false;
    const Deadline deadline = m_deadline, for_more = m_deadline_for_more;
    m_boundary_part.begin(*m_garment, m_last, boundary, parts, BoundaryPart::Surfaces::left_out);
    m_contact_part.begin(m_contacts, parts);
    m_part_ends.resize(static_cast<size_t>(parts) - 1);
    bool finite = true;
    for (int k = 0; k < parts && finite; ++k) {
        if (k > 0) {
            m_part_ends[static_cast<size_t>(k) - 1] = m_x;
            accept_part();
        }
        const Boundary& part = m_boundary_part.take(k);
        const SurfaceContacts& contacts = m_contact_part.take(k, m_last.x);
        share(deadline, parts - k, m_deadline);
        share(for_more, parts - k, m_deadline_for_more);
        begin(part, contacts, m_last_dt, unrepelled);
        m_quasi_newton.set_continued(k > 0);
        if (!predicted) {
            finite = minimise_part(part, contacts, of_each, Start::guess, limits, report);
            rejected = rejected || report.prediction_rejected;
            continue;
        }
        const PotentialValue* at_x = start_from_acceleration(part, contacts, report);
        predicted = !report.prediction_rejected;
        report.prediction_rejected = report.prediction_rejected && k == 0;
        finite = descend(part, limits, at_x, m_last, report);
    }
    report.prediction_rejected = report.prediction_rejected || rejected;
    m_quasi_newton.set_continued(false);
    m_deadline = deadline;
    m_deadline_for_more = for_more;
    return finite;
}

/// What the start says of the whole step. False: it failed.
bool StepSolver::predict_acceleration(const Boundary& boundary, double dt, StepStart& start,
                                      const std::vector<char>& unrepelled, StepReport& report) {
    begin(boundary, m_contacts, dt, unrepelled);
    choose_start(boundary, m_contacts, &start, IterationLimits::none(), dt, m_last, report);
    m_acceleration = (m_started - m_guess) / (dt * dt);
    return !report.prediction_rejected;
}

/// Leaves where a part starts in m_x; returns E and its gradient there.
const PotentialValue* StepSolver::start_from_acceleration(const Boundary& boundary,
                                                          const SurfaceContacts& contacts,
                                                          StepReport& report) {
    choose_start(boundary, contacts, nullptr, IterationLimits::none(), m_last_dt, m_last, report);
    m_started = m_guess + m_last_dt * m_last_dt * m_acceleration;
    place_pins(*m_garment, boundary, m_started);
    const PotentialValue* const at_x = lower_of_guess_and_prediction(false, report);
    m_x = m_started;
    return at_x;
}

/// A part's share of the time that is left, for so many of them and contact projection.
void StepSolver::share(const Deadline& whole, int parts, Deadline& part) const {
    if (whole.is_set())
        part = Deadline::in(m_contact_ms + whole.earlier(m_contact_ms).left() / parts);
}

/// From m_last, with m_potential begun.
bool StepSolver::minimise_part(const Boundary& boundary, const SurfaceContacts& contacts,
                               StepStart* start, Start from, const IterationLimits& limits,
                               StepReport& report) {
    const PotentialValue* at_x = nullptr;
    if (from == Start::guess)
        at_x = choose_start(boundary, contacts, start, limits, m_last_dt, m_last, report);
    if (from == Start::guess && !start && !at_x) let_fall(boundary, contacts);
    if (from == Start::outside) at_x = start_outside(boundary, contacts, start, limits, report);
    if (start && limits.iterations == 0 && !at_x) return true;  // as it was predicted
    if (!descend(boundary, limits, at_x, m_last, report)) return false;
    const bool few = (!start || m_parts > 1) && m_settings.small_step_rate > 0.0;  // iterations
    return !few || undo_gain(boundary, contacts, limits, report);
}

/// Where a part of the cloth lands and the rest goes on, guesses are stretched more than few
/// iterations undo. A part that ends with more energy than if all of the cloth stopped has made
/// some. It goes on from the least energy on the way from there to its end.
bool StepSolver::undo_gain(const Boundary& boundary, const SurfaceContacts& contacts,
                           const IterationLimits& limits, StepReport& report) {
    resting_guess(*m_garment, m_last, boundary, contacts, 0.0,
                  m_potential.settings().contact_distance, m_stop);
    if (m_energy <= m_potential.value_of_motion(m_stop)) return true;
    const double at_stop = m_potential.value(m_stop);
    if (m_energy <= at_stop) return true;
    m_x = m_stop + lowest_towards_end(at_stop) * (m_x - m_stop);
    return descend(boundary, limits, nullptr, m_last, report);
}

/// Of the way from m_stop to m_x, whose energies are `at_stop` and m_energy: by the parabola
/// through these and the middle's. 0 to 1, no higher than at_stop.
double StepSolver::lowest_towards_end(double at_stop) {
    const auto energy_at = [this](double share) {
        m_between = m_stop + share * (m_x - m_stop);
        return m_potential.value(m_between);
    };
    const double at_middle = energy_at(0.5);
    const double curvature = 2.0 * (m_energy - 2.0 * at_middle + at_stop);
    const double slope = m_energy - at_stop - curvature;
    const double lowest = std::min(at_stop, at_middle), share = at_middle < at_stop ? 0.5 : 0.0;
    if (!(curvature > 0.0)) return share;
    const double vertex = std::clamp(-0.5 * slope / curvature, 0.0, 1.0);
    return energy_at(vertex) < lowest ? vertex : share;
}

/// m_last goes on to m_x.
void StepSolver::accept_part() {
    m_v = (m_x - m_last.x) / m_last_dt;
    m_time.end_step(m_last, m_x, m_v, m_last_dt);
    m_potential.friction().remember(m_x, m_last.stick);
    m_last.x = m_x;
    m_last.v = m_v;
}

/// Contact projection of m_x, which becomes the state.
StepReport StepSolver::finish(const Boundary& boundary, double dt, ClothState& state,
                              StepReport report) {
    Stopwatch watch;
    m_v = m_x;
    project(boundary, state, report);
    m_contact_ms = report.times.contact = watch.lap();
    if (!accept(dt, state)) return StepReport::failed();
    m_self_contact.untangle(
        {boundary, m_proximity, m_goals, m_settings.safety_distance, m_contacts}, dt, state,
        report);
    m_potential.friction().remember(state.x, state.stick);
    return report;
}

void StepSolver::internal_forces(const Points& x, Points& forces) const {
    m_potential.internal_forces(x, forces);
    if (m_parts == 1 || !same_points(x, m_x)) return;
    static thread_local Points at_end;  // of the thread that calls
    for (const Points& end : m_part_ends) {
        m_potential.internal_forces(end, at_end);
        forces += at_end;
    }
    forces /= static_cast<double>(m_parts);
}

void StepSolver::find_contacts(const Boundary& boundary, const Points& x, StepEnd end) {
    if (boundary.obstacles.empty()) {
        m_contacts.clear();
        return;
    }
    m_proximity.query(x, boundary, m_contacts, end);
    m_ridges.find(m_proximity, boundary, x, m_contacts, end);
}

/// From m_last on.
void StepSolver::begin(const Boundary& boundary, const SurfaceContacts& contacts, double dt,
                       const std::vector<char>& unrepelled) {
    const InertialStep* inertia =
        m_time.begin_step(m_last, contacts, m_potential.settings().contact_distance, dt);
    m_potential.begin_step(m_last, boundary, contacts, dt, inertia, unrepelled);
}

/// Leaves where to start in m_x; returns E and its gradient there if they are known.
const PotentialValue* StepSolver::choose_start(const Boundary& boundary,
                                               const SurfaceContacts& contacts, StepStart* start,
                                               const IterationLimits& limits, double dt,
                                               const ClothState& state, StepReport& report) {
    // Networks learned from the one; Newton's method reaches the minimum from either.
    const bool resting = !start && m_settings.minimiser == MinimiserKind::quasi_newton;
    const auto guess = resting ? resting_guess : starting_guess;
    guess(*m_garment, state, boundary, contacts, dt, m_potential.settings().contact_distance,
          m_guess);
    m_potential.separate_self_contact(m_guess);
    m_x = m_guess;
    if (m_parts == 1 && m_next_start.rows() == m_guess.rows()) return start_as_told(boundary);
    return start ? ask(*start, boundary, limits, state, report) : nullptr;
}

/// Cloth that nothing holds starts where forces take it as a whole. Iterations that had to find out
/// would have that motion in their history together with that of the shape, and repeat a part of
/// it: momentum from nothing.
void StepSolver::let_fall(const Boundary& boundary, const SurfaceContacts& contacts) {
    if (m_settings.minimiser != MinimiserKind::quasi_newton) return;
    if (!m_garment->pins().empty() || m_garment->has_goals()) return;
    const VectorX& masses = m_garment->masses();
    const double dt2 = m_potential.inertial_dt() * m_potential.inertial_dt();
    const bool is_pushed = boundary.accelerations.rows() > 0;
    Vec3 moment = Vec3::Zero();
    for (Eigen::Index i = 0; i < m_x.rows(); ++i) {
        moment += masses[i] * (m_potential.inertial_target().row(i) - m_x.row(i)).transpose();
        if (is_pushed) moment += masses[i] * dt2 * boundary.accelerations.row(i).transpose();
    }
    const Vec3 way = moment / masses.sum() + dt2 * boundary.gravity;
    if (is_clear_of(contacts, way.norm())) m_x.rowwise() += way.transpose();
}

/// Whether the cloth is farther (m) from all obstacles, at t and in m_x, than they act.
bool StepSolver::is_clear_of(const SurfaceContacts& contacts, double farther) const {
    if (contacts.obstacle.empty()) return true;
    const PotentialSettings& settings = m_potential.settings();
    const double near = std::max(settings.contact_distance, settings.friction_distance) + farther;
    for (Eigen::Index i = 0; i < m_x.rows(); ++i) {
        if (!contacts.has(i)) continue;
        const double height = (m_x.row(i) - contacts.point1.row(i)).dot(contacts.normal1.row(i));
        if (std::min(contacts.distance[i], height) < near) return false;
    }
    return contacts.ridges.empty();
}

/// At m_next_start, or at m_guess if that is of less energy.
const PotentialValue* StepSolver::start_as_told(const Boundary& boundary) {
    m_started.swap(m_next_start);
    m_next_start.resize(0, 3);
    place_pins(*m_garment, boundary, m_started);
    StepReport rejected;  // is no prediction
    const PotentialValue* at_x = lower_of_guess_and_prediction(false, rejected);
    m_x = m_started;
    return at_x;
}

/// The same for m_x in the place of the extrapolation.
const PotentialValue* StepSolver::start_outside(const Boundary& boundary,
                                                const SurfaceContacts& contacts, StepStart* start,
                                                const IterationLimits& limits, StepReport& report) {
    m_guess = m_x;
    if (!contacts.obstacle.empty())
        project_out(contacts, m_potential.settings().contact_distance, m_guess);
    place_pins(*m_garment, boundary, m_guess);
    m_potential.separate_self_contact(m_guess);
    m_x = m_guess;
    return start ? ask(*start, boundary, limits, m_last, report) : nullptr;
}

/// What the start adds to m_guess.
const PotentialValue* StepSolver::ask(StepStart& start, const Boundary& boundary,
                                      const IterationLimits& limits, const ClothState& state,
                                      StepReport& report) {
    StageTimes times;
    const bool guess_known =
        start.predict(state, boundary, m_potential, m_guess, m_at_guess, m_started, times);
    report.times.features += times.features;
    report.prediction_rejected = m_started.rows() != m_guess.rows() || !m_started.allFinite();
    if (report.prediction_rejected)
        m_started = m_guess;
    else
        place_pins(*m_garment, boundary, m_started);
    const bool refined = limits.iterations > 0 || m_settings.minimiser == MinimiserKind::newton;
    const PotentialValue* at_x =
        refined ? lower_of_guess_and_prediction(guess_known, report) : nullptr;
    m_x = m_started;
    return at_x;
}

const PotentialValue* StepSolver::lower_of_guess_and_prediction(bool guess_known,
                                                                StepReport& report) {
    if (!guess_known) m_at_guess.energy = m_potential.value_gradient(m_guess, m_at_guess.gradient);
    if (report.prediction_rejected) return &m_at_guess;
    m_at_prediction.energy = m_potential.value_gradient(m_started, m_at_prediction.gradient);
    if (m_at_prediction.energy <= m_at_guess.energy) return &m_at_prediction;
    report.prediction_rejected = true;
    m_started = m_guess;
    return &m_at_guess;
}

MinimiseReport StepSolver::minimise(const IterationLimits& limits, const PotentialValue* at_x) {
    if (m_settings.minimiser == MinimiserKind::newton)
        return m_newton.minimise(m_potential, m_x, at_x);
    return m_quasi_newton.minimise(m_potential, m_x, adjusted(limits), at_x,
                                   m_deadline.earlier(m_contact_ms),
                                   m_deadline_for_more.earlier(m_contact_ms));
}

/// A garment that goals hold is thrown about by a character. What few conjugate gradients leave of
/// that grows from part to part; the history's iterations, whose matrix is solved with exactly,
/// take it away.
bool StepSolver::iterates_after_newton() const {
    return m_parts > 1 && m_settings.quasi_newton.hessian_cg_iterations > 0 &&
           m_garment->has_goals();
}

void StepSolver::iterate_after_newton(MinimiseReport& minimum) {
    m_quasi_newton.set_by_hessian(false);
    MinimiseReport more = minimise(IterationLimits::exactly(iterations_at_goals), nullptr);
    m_quasi_newton.set_by_hessian(true);
    if (!more.finite) return;
    more.iterations += minimum.iterations;
    more.out_of_time = more.out_of_time || minimum.out_of_time;
    minimum = more;
}

/// From m_x to the minimum, or as far as the limits allow. False: nothing is finite.
bool StepSolver::descend(const Boundary& boundary, const IterationLimits& limits,
                         const PotentialValue* at_x, const ClothState& state, StepReport& report) {
    MinimiseReport minimum = minimise(limits, at_x);
    if (!minimum.finite) {
        m_x = state.x;
        place_pins(*m_garment, boundary, m_x);
        minimum = minimise(limits, nullptr);
    }
    if (minimum.finite && iterates_after_newton()) iterate_after_newton(minimum);
    m_energy = minimum.energy;
    report.iterations += minimum.iterations;
    report.residual = minimum.residual;
    report.gain = minimum.gain;
    report.converged = minimum.converged;
    report.out_of_time = report.out_of_time || minimum.out_of_time;
    return minimum.finite;
}

/// Good as long as its arguments are.
ContactProjection::WayIn StepSolver::way_in(const Boundary& boundary, const Points& before) const {
    if (!m_ways_in) return nullptr;
    return [&](const SurfaceSamples& samples, int sample) -> std::optional<HalfSpace> {
        const auto in = m_ways_in->way_in(boundary, samples, sample, before);
        if (!in) return std::nullopt;
        return HalfSpace{in->normal1, in->normal1.dot(in->point1)};
    };
}

void StepSolver::project(const Boundary& boundary, const ClothState& state, StepReport& report) {
    place_pins(*m_garment, boundary, m_x);
    const double distance = m_settings.safety_distance;
    m_goals.begin_step(boundary.goals);
    const ResolveReport resolved = m_goals.finish(m_projection, m_proximity, boundary, distance,
                                                  m_x, m_contacts, way_in(boundary, state.x));
    report.max_penetration = resolved.deepest_after();
    report.max_entry = resolved.max_depth_before;
    m_self_contact.finish(state.x, {boundary, m_proximity, m_goals, distance, m_contacts}, m_x,
                          report);
    m_self_contact.count_tangles(m_x, boundary.overlapped, report);
    report.vertices_beyond_goals = m_goals.last().beyond;
    report.max_goal_excess = m_goals.last().max_excess;
}

/// m_x after contact projection becomes the state; m_v, m_x before it, the velocity at its end.
bool StepSolver::accept(double dt, ClothState& state) {
    end_velocities(dt, state);
    if (!m_x.allFinite() || !m_v.allFinite()) return false;  // very short steps overflow
    m_time.end_step(m_last, m_x, m_v, m_last_dt);
    state.v = (m_x - state.x) / dt;
    state.x = m_x;
    state.time += dt;
    return true;
}

/// The projection of a whole step says little of velocities at the end of its last part: what it
/// moved keeps its own, but for what leads into the surface.
void StepSolver::end_velocities(double dt, const ClothState& state) {
    if (m_parts == 1) {
        m_v = (m_x - state.x) / dt;
        return;
    }
    for (Eigen::Index i = 0; i < m_x.rows(); ++i) {
        const bool moved = m_x.row(i) != m_v.row(i);
        m_v.row(i) = (m_v.row(i) - m_last.x.row(i)) / m_last_dt;
        if (!moved || m_contacts.obstacle.empty() || !m_contacts.has(i)) continue;
        const Vec3 normal = m_contacts.normal1.row(i);
        const double inward = normal.dot(m_v.row(i).transpose() - m_contacts.velocity(i, dt));
        if (inward < 0.0) m_v.row(i) -= inward * normal.transpose();
    }
}

}  // namespace cloth
