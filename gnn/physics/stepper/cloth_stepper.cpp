#include "gnn/physics/stepper/cloth_stepper.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "data/core/check_range.h"
#include "data/core/skin_goals.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/part_report.h"
#include "gnn/physics/stepper/relative_motion.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {
namespace {

void check(const GuardSettings& settings) {
    check_range("GuardSettings.max_motion", settings.max_motion, 0.01, 1.0);
    check_range("GuardSettings.max_entry", settings.max_entry, 1e-3, 0.1);
    check_range("GuardSettings.fine_motion", settings.fine_motion, 0.01, 1.0);
    check_range("GuardSettings.watch_motion", settings.watch_motion, 5e-3, 1.0);
    check_range("GuardSettings.tunnelling_motion", settings.tunnelling_motion, 1e-3, 1.0);
    check_range("GuardSettings.max_substeps", settings.max_substeps, 1, 64);
    check(settings.iterations, "GuardSettings.iterations");
}

constexpr double kVisible = 1e-3;  // m: depth inside an obstacle that counts
constexpr double kPulled = 1.5;    // stretch from which neighbours follow what is taken back
constexpr double kTorn = 2.0;      // stretch of torn cloth
constexpr double kOfLimit = 0.93;  // that is planned with: what contact takes varies

LimbOverlapSettings limb_settings(const StepSolver* solver) {
    constexpr double room = 3.0;  // of layers, in thicknesses: one between them, and to each skin
    LimbOverlapSettings settings;
    if (solver) settings.layer_room = room * solver->settings().potential.self_contact.thickness;
    return settings;
}

/// Whether a vertex that moved is farther beyond the limits of its goal than it was.
bool goes_beyond_goals(const Garment& garment, const SkinGoals& goals, const Points& before,
                       const Points& after) {
    if (!garment.has_goals()) return false;
    std::vector<VertexGoal> limited;
    take_goals(garment.goal_limits(), goals, garment.is_pinned(), 1.0, limited);
    return std::any_of(limited.begin(), limited.end(), [&](const VertexGoal& goal) {
        const Vec3 from = before.row(goal.vertex), to = after.row(goal.vertex);
        return from != to && goal.excess(to) > goal.excess(from);
    });
}

/// Whether a vertex that moved has made an edge longer than `most` times its length at rest.
bool stretches(const Garment& garment, double most, const Points& before, const Points& after) {
    const Points& rest = garment.rest().vertices;
    const auto length = [](const Points& x, int a, int b) { return (x.row(a) - x.row(b)).norm(); };
    return std::any_of(garment.edges().begin(), garment.edges().end(), [&](const auto& edge) {
        const auto [a, b] = edge;
        if (before.row(a) == after.row(a) && before.row(b) == after.row(b)) return false;
        const double now = length(after, a, b);
        return now > most * length(rest, a, b) && now > length(before, a, b);
    });
}

/// What a part like this takes (ms) with as many iterations as it needs to be worth its while:
/// cloth that is cut into parts of one or two tears, and is farther off than in one step of as
/// many.
double least_ms(const StepReport& report, const IterationLimits& limits) {
    constexpr int kWorthwhile = 5;
    return report.times.proximity + report.times.contact +
           std::min(limits.iterations, kWorthwhile) * report.times.solve /
               std::max(1, report.iterations);
}

}  // namespace

ClothStepper::ClothStepper(const Garment& garment, const ClothStepperSettings& settings,
                           const std::shared_ptr<StepStart>& start)
    : ClothStepper(garment, settings, start, std::make_shared<ObstacleTrees>()) {
}

ClothStepper::ClothStepper(const Garment& garment, const ClothStepperSettings& settings,
                           const std::shared_ptr<StepStart>& start,
                           const std::shared_ptr<ObstacleTrees>& trees)
    : ClothStepper(garment, std::make_unique<StepSolver>(garment, settings.step, start, trees),
                   settings.guard, settings.substeps, trees) {
    check_range("ClothStepperSettings.max_ms", settings.max_ms, 0.1,
                std::numeric_limits<double>::infinity());
    set_max_ms(settings.max_ms);
}

ClothStepper::ClothStepper(const Garment& garment, std::unique_ptr<StepSolver> solver,
                           const GuardSettings& guard, int substeps)
    : ClothStepper(garment, std::move(solver), guard, substeps, std::make_shared<ObstacleTrees>()) {
}

ClothStepper::ClothStepper(const Garment& garment, std::unique_ptr<StepSolver> solver,
                           const GuardSettings& guard, int substeps,
                           std::shared_ptr<ObstacleTrees> trees)
    : m_garment(&garment),
      m_guard(guard),
      m_substeps(substeps),
      m_solver(std::move(solver)),
      m_trees(std::move(trees)),
      m_limbs(limb_settings(m_solver.get()), m_trees, m_solver ? &m_solver->proximity() : nullptr),
      m_detector(garment, m_trees),
      m_pull(garment, kPulled) {
    if (!m_solver) throw ArgumentError("solver", "is null", "give the solver of one step");
    check(m_guard);
    check_range("ClothStepperSettings.substeps", substeps, 1, 64);
    if (fixed_dt() > 0.0) prepare(fixed_dt());
}

std::string ClothStepper::name() const {
    return m_solver->name() + (m_substeps > 1 ? "x" + std::to_string(m_substeps) : "");
}

void ClothStepper::prepare(double dt) {
    m_solver->prepare(dt / m_substeps);
    if (m_substeps == 1) m_solver->prepare(dt / m_solver->small_steps(dt));
    for (int parts = 2; parts < 2 * m_guard.max_substeps; parts *= 2) {
        const double part = dt / std::min(parts, m_guard.max_substeps);
        m_solver->prepare(part);
        m_solver->prepare(part / m_solver->small_steps(part));
    }
}

bool ClothStepper::set_max_ms(double ms) {
    m_max_ms = ms;
    return m_solver->settings().minimiser != MinimiserKind::newton;
}

bool ClothStepper::set_max_iterations(int most) {
    m_solver->set_max_iterations(most);
    return m_solver->settings().minimiser != MinimiserKind::newton;
}

bool ClothStepper::set_most_residual(double most) {
    m_solver->set_most_residual(most);
    return m_solver->settings().minimiser != MinimiserKind::newton;
}

bool ClothStepper::internal_forces(const Points& x, Points& forces) const {
    m_solver->internal_forces(x, forces);
    return true;
}

StepReport ClothStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt)) {
        m_solver->start_next_at(Points());
        return StepReport::failed();
    }
    m_deadline = std::isinf(m_max_ms) ? Deadline() : Deadline::in(kOfLimit * m_max_ms);
    m_trees->begin_step();
    if (!m_guard.limbs) return guarded_step(boundary, dt, state);
    Stopwatch watch;
    const Boundary& outside = m_limbs.filter(boundary, dt, state);
    double limbs_ms = watch.lap();
    m_deadline = m_deadline.earlier(m_ignored_ms);
    StepReport report = guarded_step(outside, dt, state);
    watch.lap();
    if (report.finite) {
        report_ignored(state.x, report);
        m_ignored_ms = watch.lap();
        limbs_ms += m_ignored_ms;
    }
    report.times.proximity += limbs_ms;
    return report;
}

/// What contact leaves alone is no penetration, but nobody should take it for air either.
void ClothStepper::report_ignored(const Points& x, StepReport& report) {
    const IgnoredDepth ignored = m_limbs.measure_ignored(x, m_garment->is_pinned());
    report.vertices_in_ignored_limbs = ignored.vertices;
    report.max_ignored_depth = ignored.depth;
}

/// A step that turns out to be too coarse is taken once more, as finely as its report asks for.
StepReport ClothStepper::guarded_step(const Boundary& boundary, double dt, ClothState& state) {
    if (is_watched())  // a search must not begin with building in the midst of an animation
        for (const Obstacle& obstacle : boundary.obstacles)
            (boundary.trees ? *boundary.trees : *m_trees).prepare_motion(obstacle);
    const double motion = is_watched() ? relative_motion(*m_garment, boundary, dt, state) : 0.0;
    const int safe = std::max(m_substeps, substeps_for(motion, m_guard.max_motion));
    const int foreseen = affordable(safe, m_substeps);
    const bool may_repeat = foreseen < m_guard.max_substeps;
    if (may_repeat) m_before = state;
    const bool goes_on = same_points(m_lag.x, state.x);
    StepReport report = foreseen == 1 ? take_whole(boundary, dt, motion, state)
                                      : take_parts(foreseen, boundary, dt, Cut::by_motion, state);
    Lag lag = std::exchange(m_next_lag, {});
    const int asked = may_repeat ? substeps_after(report, dt, motion) : foreseen;
    const int finer = affordable(asked, report.finite ? foreseen : std::min(asked, 2));
    const bool shortened = foreseen < safe || finer < asked;
    if (finer > foreseen) {
        // What was corrected in vain, or is cut more finely now, is not worth more corrections.
        const StepReport repeated = take_parts(finer, boundary, dt, Cut::again, m_before);
        if (repeated.finite || !report.finite) {
            if (repeated.finite) std::swap(state, m_before);
            report = repeated;
            std::swap(lag, m_next_lag);
        }
    }  // better the first step than none
    report.out_of_time = report.out_of_time || shortened;
    if (report.finite && lag.parts > 1) {
        if (goes_on) std::swap(m_lag_before, m_lag);
        std::swap(m_lag, lag);
    }
    return report;
}

StepReport ClothStepper::take_whole(const Boundary& boundary, double dt, double motion,
                                    ClothState& state) {
    const bool should_search = is_watched() && motion > m_guard.watch_motion;
    // Iterations come first: without them cloth tears, without the search a hand may pass through.
    const bool search_it = should_search && m_search_ms + m_part_ms <= m_deadline.left();
    m_solver->set_deadline(m_deadline);
    if (search_it)
        m_solver->set_deadline(m_deadline.earlier(m_search_ms),
                               m_deadline.earlier(std::max(0.5 * m_deadline.left(), m_search_ms)));
    m_solver->set_ways_in(search_it ? &m_detector : nullptr);
    if (is_watched()) m_start = state;
    const int wanted = m_solver->small_steps(dt, state);
    const int small_steps = affordable_small_steps(wanted);
    StepReport report = small_steps > 1 ? take_small_steps(small_steps, boundary, dt, state)
                                        : take_one(boundary, dt, state);
    if (search_it && report.finite) search(boundary, dt, Neighbours::stay, state, report);
    if (should_search && !search_it) {
        report.out_of_time = true;
        m_search_ms *= 0.9;  // the next ones may be cheaper
    }
    report.out_of_time = report.out_of_time || small_steps < wanted;
    m_iteration_ms = report.times.solve / std::max(1, report.iterations);
    m_part_ms = least_ms(report, m_guard.iterations);
    if (is_watched() && m_part_ms + m_search_ms <= m_deadline.left()) {
        m_solver->set_deadline(m_deadline.earlier(m_search_ms));
        correct(boundary, dt, m_guard.iterations, search_it, state, report);
    }
    return report;
}

StepReport ClothStepper::take_one(const Boundary& boundary, double dt, ClothState& state) {
    m_state.v = state.v;
    add_lag(1, dt, state);
    if (is_watched()) m_start.v = state.v;
    const StepReport report = is_made_for(dt)
                                  ? m_solver->whole(boundary, dt, state)
                                  : m_solver->part(boundary, dt, m_guard.iterations, state);
    if (!report.finite) state.v = m_state.v;
    return report;
}

StepReport ClothStepper::take_small_steps(int count, const Boundary& boundary, double dt,
                                          ClothState& state) {
    m_state.v = state.v;
    add_lag(count, dt, state);
    const auto from = is_made_for(dt) ? StepSolver::From::start : StepSolver::From::guess;
    const StepReport report = m_solver->in_small_steps(count, boundary, dt, from, state);
    if (report.finite) {
        m_next_lag.v = m_solver->end_velocity() - state.v;
        keep_lag(count, dt, state.x);
    } else {
        state.v = m_state.v;
    }
    return report;
}

bool ClothStepper::is_made_for(double dt) const {
    constexpr double kSame = 1e-3;  // callers' time steps are floats
    return fixed_dt() == 0.0 || std::abs(dt - fixed_dt()) < kSame * fixed_dt();
}

StepReport ClothStepper::take_parts(int substeps, const Boundary& boundary, double dt, Cut cut,
                                    ClothState& state) {
    StepReport report;
    report.converged = true;
    report.substeps = substeps;
    m_solver->start_next_at(Points());  // it is that of a whole step
    m_state = state;
    const int all_steps = substeps * std::max(1, small_steps_of_part(cut, dt / substeps));
    add_lag(all_steps, dt, m_state);
    // What is cut because the settings say so obeys the settings' limits.
    const IterationLimits& own = m_solver->settings().quasi_newton;
    const IterationLimits& limits = substeps <= m_substeps ? own : m_guard.iterations;
    m_part.begin(*m_garment, state, boundary, substeps);
    if (boundary.trees)  // poses of parts are no other garment's: they stay out of the world's
        for (const Obstacle& obstacle : boundary.obstacles) {
            boundary.trees->surface(obstacle, StepEnd::start);  // so that there is one to adopt
            m_trees->adopt(*boundary.trees, obstacle);
        }
    m_part_ms = 0.0;
    for (int k = 0; k < substeps; ++k) {
        if (k > 0) m_trees->begin_step();
        if (m_deadline.is_set())
            m_solver->set_deadline(Deadline::in(m_deadline.left() / (substeps - k)));
        const StepReport part = take_part(m_part.take(k), dt / substeps, limits, cut);
        add_part(part, report);
        if (!report.finite) return report;
        m_part_ms += least_ms(part, limits) / substeps;
    }
    m_state.time = state.time + dt;
    m_next_lag.v = m_state.v;
    m_state.v = (m_state.x - state.x) / dt;
    m_next_lag.v -= m_state.v;
    keep_lag(all_steps, dt, m_state.x);
    std::swap(state, m_state);
    return report;
}

/// Of a constant acceleration a, the last of N parts ends faster than their mean by (N - 1) / 2N a
/// dt. A step of another length goes on from there; if it is far shorter than these parts, it would
/// show what rings in them, and goes on from nearer to the mean. Steps of one length and other
/// numbers of parts go on from where their means do; but whole steps that were cut for their motion
/// alone go on without: what is lost damps what moves so fast.
void ClothStepper::add_lag(int parts, double dt, ClothState& state) const {
    constexpr double same = 1e-3, far_shorter = 0.25;
    const auto share = [](int count) { return static_cast<double>(count - 1) / count; };
    for (const Lag* lag : {&m_lag, &m_lag_before}) {
        if (lag->parts < 2 || !same_points(lag->x, state.x)) continue;
        const bool may_differ = m_solver->settings().small_step_rate > 0.0 && m_substeps == 1;
        const bool is_as_long = std::abs(dt - lag->dt) < same * dt;
        if (lag->parts != parts && !may_differ) return;
        if (lag->parts == parts)
            state.v += lag->v;
        else if (is_as_long)
            state.v += share(parts) / share(lag->parts) * lag->v;
        else
            state.v += std::min(1.0, dt * lag->parts / (far_shorter * lag->dt)) * lag->v;
        return;
    }
}

void ClothStepper::moved(const Points& before, const Points& after, const Eigen::Matrix3d& turn) {
    for (Lag* lag : {&m_lag, &m_lag_before}) {
        if (lag->parts < 2 || !same_points(lag->x, before)) continue;
        lag->x = after;
        lag->v *= turn.transpose();
    }
}

/// m_next_lag.v is that of a step of so many parts, which ends at x.
void ClothStepper::keep_lag(int parts, double dt, const Points& x) {
    m_next_lag.parts = parts;
    m_next_lag.dt = dt;
    m_next_lag.x = x;
}

/// Where a step was cut because of its motion alone, contacts of each part's own are all that was
/// missing.
int ClothStepper::small_steps_of_part(Cut cut, double dt) const {
    const bool may = cut == Cut::by_motion && m_substeps == 1;
    return may ? m_solver->small_steps_of_part(dt, m_state) : 0;
}

/// Advances m_state.
StepReport ClothStepper::take_part(const Boundary& part, double dt, const IterationLimits& limits,
                                   Cut cut) {
    const double motion = is_watched() ? relative_motion(*m_garment, part, dt, m_state) : 0.0;
    const bool search_it = motion > m_guard.watch_motion;
    m_solver->set_ways_in(search_it ? &m_detector : nullptr);
    if (is_watched()) m_start = m_state;
    const int count = small_steps_of_part(cut, dt);
    StepReport report =
        count > 0 ? m_solver->in_small_steps(count, part, dt, StepSolver::From::start, m_state)
                  : m_solver->part(part, dt, limits, m_state);
    if (count > 1 && report.finite) m_state.v = m_solver->end_velocity();
    if (search_it && report.finite) search(part, dt, Neighbours::stay, m_state, report);
    if (is_watched() && !m_deadline.is_set() && cut == Cut::by_motion)
        correct(part, dt, limits, search_it, m_state, report);
    return report;
}

/// A step that went past a surface, or through a solid, is taken on with contacts that hold it
/// there. Most need nothing else; the others are taken again in parts.
void ClothStepper::correct(const Boundary& boundary, double dt, const IterationLimits& limits,
                           bool searched, ClothState& state, StepReport& report) {
    if (!report.finite || !went_past(report)) return;
    m_corrected = m_start;
    StepReport corrected = m_solver->correct(boundary, dt, report.tunnelled ? &m_detector : nullptr,
                                             limits, m_corrected);
    if (!corrected.finite) return;
    if (searched) search(boundary, dt, Neighbours::may_follow, m_corrected, corrected);
    report.times += corrected.times;
    report.iterations += corrected.iterations;
    if (!are_few(corrected.points_tunnelled) ||
        corrected.points_tunnelled > report.points_tunnelled ||
        corrected.max_entry > std::max(report.max_entry, m_guard.max_entry) ||
        corrected.max_penetration > std::max(report.max_penetration, kVisible))
        return;
    corrected.iterations = report.iterations;
    corrected.times = report.times;
    corrected.prediction_rejected = report.prediction_rejected;
    corrected.out_of_time = corrected.out_of_time || report.out_of_time;
    report = corrected;
    std::swap(state, m_corrected);
    m_next_lag.x = state.x;  // that of the parts that were corrected, if there were any
}

/// Looks for what a step from m_start went through. Where that are few points they are moved back
/// to where they went in, which costs next to nothing.
void ClothStepper::search(const Boundary& boundary, double dt, Neighbours neighbours,
                          ClothState& state, StepReport& report) {
    if (m_deadline.left() < m_search_ms) {
        report.out_of_time = true;
        return;
    }
    Stopwatch watch;
    const auto count = static_cast<int>(m_detector.find(boundary, m_start.x, state.x, 0).size());
    if (count > 0 && are_few(count)) take_back(boundary, dt, neighbours, state, report);
    if (report.max_penetration > kVisible)
        m_detector.add_samples(boundary, m_start.x, state.x, kVisible);
    report.tunnelled = m_detector.thinnest();
    report.points_tunnelled = static_cast<int>(m_detector.found().size());
    m_search_ms = watch.lap();
    report.times.contact += m_search_ms;
}

/// All of them, or none where goals do not allow it, or it would tear the cloth. Neighbours that
/// may follow do where it would stretch the cloth much.
void ClothStepper::take_back(const Boundary& boundary, double dt, Neighbours neighbours,
                             ClothState& state, StepReport& report) {
    struct Attempt {
        NeighbourPull* pull;
        double most_stretch;
    };
    std::vector<Attempt> attempts = {{nullptr, kTorn}};
    if (neighbours == Neighbours::may_follow)
        attempts = {{nullptr, kPulled}, {&m_pull, kTorn}, {nullptr, kTorn}};
    m_searched = state.x;
    for (const Attempt& attempt : attempts) {
        if (&attempt != &attempts.front() && m_deadline.left() < m_search_ms) {
            report.out_of_time = true;
            break;
        }
        const double depth = m_detector.take_back(
            boundary, m_start.x, m_solver->settings().safety_distance, 0, state.x, attempt.pull);
        if (!goes_beyond_goals(*m_garment, boundary.goals, m_searched, state.x) &&
            !stretches(*m_garment, attempt.most_stretch, m_searched, state.x)) {
            report.max_penetration = std::max(report.max_penetration, depth);
            break;
        }
        state.x = m_searched;
        m_detector.find(boundary, m_start.x, state.x, 0);
    }
    for (Eigen::Index i = 0; i < state.x.rows(); ++i)
        if (state.x.row(i) != m_searched.row(i))
            state.v.row(i) = (state.x.row(i) - m_start.x.row(i)) / dt;
    if (same_points(m_next_lag.x, m_searched)) m_next_lag.x = state.x;
}

/// Of points that went through something: no step is taken again for them.
bool ClothStepper::are_few(int points) const {
    return points <= std::max<Eigen::Index>(1, m_garment->vertex_count() / 100);
}

/// How finely a step of this motion from m_before should have been taken. Cloth that hardly moved
/// took a whole one, however the solver steps otherwise.
int ClothStepper::substeps_after(const StepReport& report, double dt, double motion) const {
    int substeps = report.finite ? 1 : 2;
    const bool is_fine = m_substeps == 1 && m_solver->small_steps(dt, m_before) > 1;
    if (report.max_entry > m_guard.max_entry && !is_fine)
        substeps = std::max(substeps, substeps_for(motion, m_guard.fine_motion));
    if (!are_few(report.points_tunnelled))
        substeps = std::max(substeps, substeps_for(motion, std::min(m_guard.tunnelling_motion,
                                                                    0.5 * *report.tunnelled)));
    return substeps;
}

/// As many parts as there is time for.
int ClothStepper::affordable(int substeps, int least) const {
    const double left = m_deadline.left();
    while (substeps > least && substeps * m_part_ms > left)
        substeps = std::max(least, substeps / 2);
    return substeps;
}

/// Halved until each has time for the iterations that make it worthwhile.
int ClothStepper::affordable_small_steps(int count) const {
    const double each_ms = m_solver->worthwhile_iterations() * m_iteration_ms;
    while (count > 1 && count * each_ms > m_deadline.left()) count = (count + 1) / 2;
    return count;
}

/// Powers of two, so that few matrices are factorised.
int ClothStepper::substeps_for(double motion, double most) const {
    int substeps = 1;
    while (substeps * most < motion && substeps < m_guard.max_substeps) substeps *= 2;
    return std::min(substeps, m_guard.max_substeps);
}

}  // namespace cloth
