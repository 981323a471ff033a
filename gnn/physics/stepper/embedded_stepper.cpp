#include "gnn/physics/stepper/embedded_stepper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/proximity/obstacle_trees.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/step_solver.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {

namespace {

constexpr double kDistance = 5e-4;  // of fine vertices from obstacles (m), as all steppers keep it

const EmbeddedStepperSettings& checked(const EmbeddedStepperSettings& settings) {
    check_range("EmbeddedStepperSettings.fade", settings.fade, 0.0, 10.0);
    check_range("EmbeddedStepperSettings.detail_iterations", settings.detail_iterations, 0, 1000);
    return settings;
}

ContactProjectionSettings projection_of(const EmbeddedStepperSettings& settings) {
    ContactProjectionSettings projection;
    if (!settings.surface) projection.iterations = 0;
    return projection;
}

/// Null: the fine garment has no step of its own.
std::unique_ptr<StepSolver> detail_of(const Garment& fine, const EmbeddedStepperSettings& settings,
                                      const std::shared_ptr<StepStart>& network,
                                      const std::shared_ptr<ObstacleTrees>& trees) {
    if (settings.detail_iterations == 0 && !network) return nullptr;
    StepSettings step = StepSettings::whole(
        settings.detail_iterations > 0 ? IterationLimits::exactly(settings.detail_iterations)
                                       : IterationLimits::none());
    step.proximity = settings.proximity;
    return std::make_unique<StepSolver>(fine, step, network, trees);
}

const Garment& given(const std::shared_ptr<const Garment>& proxy, const Garment& fine) {
    if (!proxy)
        throw ArgumentError("EmbeddedStepper of " + fine.name(), "there is no proxy",
                            "make one by make_proxy()");
    return *proxy;
}

/// The limbs of any corner of each place (rows of `embedding`); none of none.
void spread_limbs(const MeshEmbedding& embedding, const std::vector<LimbSet>& limbs,
                  std::vector<LimbSet>& spread) {
    spread.clear();
    if (limbs.size() != static_cast<size_t>(embedding.coarse_size())) return;
    if (std::all_of(limbs.begin(), limbs.end(), [](LimbSet set) { return set == 0; })) return;
    spread.assign(static_cast<size_t>(embedding.size()), 0);
    for (Eigen::Index i = 0; i < embedding.size(); ++i)
        for (const int corner : embedding.corners(i))
            spread[static_cast<size_t>(i)] |= limbs[static_cast<size_t>(corner)];
}

}  // namespace

EmbeddedStepper::EmbeddedStepper(const Garment& fine, std::shared_ptr<const Garment> proxy,
                                 std::unique_ptr<Stepper> stepper,
                                 const EmbeddedStepperSettings& settings,
                                 const std::shared_ptr<StepStart>& detail)
    : m_fine(&fine),
      m_settings(checked(settings)),
      m_proxy(std::move(proxy)),
      m_stepper(std::move(stepper)),
      m_places(given(m_proxy, fine).rest(), fine.rest(), settings.embedding),
      m_proxy_places(fine.rest(), m_proxy->rest(), settings.embedding),
      m_trees(std::make_shared<ObstacleTrees>()),
      m_proximity(settings.proximity, m_trees),
      m_contact_projection(fine, projection_of(settings)),
      m_goal_projection(fine),
      m_detail(detail_of(fine, settings, detail, m_trees)),
      m_most_detail(m_proxy->mean_edge_length()) {
    if (!m_stepper)
        throw ArgumentError("EmbeddedStepper of " + fine.name(), "the proxy has no stepper",
                            "make one for the proxy, such as by make_cloth()");
    if (m_proxy->pins().empty() != fine.pins().empty() || m_proxy->has_goals() != fine.has_goals())
        throw ArgumentError("EmbeddedStepper of " + fine.name(),
                            "only one of the garment and its proxy has pins, or goals",
                            "make the proxy by make_proxy() or carry_over()");
    m_stepper->set_surface_projection(settings.proxy_surface);
    find_pins();
}

EmbeddedStepper::~EmbeddedStepper() = default;

void EmbeddedStepper::find_pins() {
    std::vector<int> place(static_cast<size_t>(m_fine->vertex_count()), -1);
    for (size_t k = 0; k < m_fine->pins().size(); ++k)
        place[static_cast<size_t>(m_fine->pins()[k])] = static_cast<int>(k);
    for (const int pin : m_proxy->pins()) {
        HeldPin held;
        const std::array<int, 3> corners = m_proxy_places.corners(pin);
        for (size_t c = 0; c < 3; ++c) {
            const int k = place[static_cast<size_t>(corners[c])];
            if (k < 0) continue;
            held.pins[c] = k;
            held.weights[static_cast<Eigen::Index>(c)] =
                m_proxy_places.weights(pin)[static_cast<Eigen::Index>(c)];
        }
        const double sum = held.weights.sum();
        if (!(sum > 1e-6))
            throw ArgumentError("EmbeddedStepper of " + m_fine->name(),
                                "pin " + std::to_string(pin) + " of its proxy is not at a pin",
                                "make the proxy by make_proxy() or carry_over()");
        held.weights /= sum;
        m_pins.push_back(held);
    }
}

std::string EmbeddedStepper::name() const {
    const std::string name = m_stepper->name() + "~" + std::to_string(m_proxy->vertex_count());
    return m_detail ? name + "+" + m_detail->name() : name;
}

double EmbeddedStepper::fixed_dt() const {
    const double dt = m_stepper->fixed_dt();
    return dt > 0.0 || !m_detail ? dt : m_detail->fixed_dt();
}

void EmbeddedStepper::prepare(double dt) {
    m_stepper->prepare(dt);
    if (m_detail) m_detail->prepare(dt);
}

bool EmbeddedStepper::set_max_iterations(int most) {
    if (m_detail) m_detail->set_max_iterations(most);
    return m_stepper->set_max_iterations(most) || m_detail;
}

bool EmbeddedStepper::is_independent() const {
    return m_stepper->is_independent() && (!m_detail || m_detail->is_independent());
}

/// Gives the proxy what the fine velocities (|V| x 3, m/s) were given since the last step.
void EmbeddedStepper::push(const Points& v) {
    if (same_points(v, m_shown.v)) return;
    m_state.v += of_proxy(v - m_shown.v);
    m_shown.v = v;
}

void EmbeddedStepper::derive(const ClothState& state) {
    m_proxy_places.positions(state.x, m_state.x);
    m_proxy_places.interpolate(state.v, m_state.v);
    m_places.positions(m_state.x, m_offset);
    m_offset = state.x - m_offset;
    m_shown = state;
}

Points EmbeddedStepper::of_proxy(const Points& fine) const {
    Points values;
    if (fine.rows() > 0) m_proxy_places.interpolate(fine, values);
    return values;
}

/// The outside of the fine garment, and as the proxy has it. Both have the obstacles' hierarchies
/// in common; the obstacles themselves, which are large, are the proxy's until it has stepped.
void EmbeddedStepper::take_boundary(const Boundary& boundary) {
    m_outside = boundary;
    if (!m_outside.trees) {
        m_outside.trees = m_trees;
        m_trees->begin_step();
    }
    std::vector<Obstacle> obstacles = std::move(m_outside.obstacles);
    m_outside.obstacles.clear();
    m_proxy_boundary = m_outside;
    m_proxy_boundary.obstacles = std::move(obstacles);
    m_proxy_boundary.pin_targets.setZero(static_cast<Eigen::Index>(m_pins.size()), 3);
    for (size_t k = 0; k < m_pins.size(); ++k)
        for (size_t c = 0; c < 3; ++c)
            m_proxy_boundary.pin_targets.row(static_cast<Eigen::Index>(k)) +=
                m_pins[k].weights[static_cast<Eigen::Index>(c)] *
                boundary.pin_targets.row(m_pins[k].pins[c]);
    m_proxy_boundary.accelerations = of_proxy(boundary.accelerations);
    spread_limbs(m_proxy_places, boundary.ignored_limbs, m_proxy_boundary.ignored_limbs);
    m_proxy_boundary.pinched.clear();  // the proxy's stepper finds out itself
    m_proxy_boundary.overlapped.clear();
    if (!m_fine->has_goals() || boundary.goals.empty()) return;
    SkinGoals& goals = m_proxy_boundary.goals;
    m_proxy_places.positions(boundary.goals.x0, goals.x0);
    m_proxy_places.positions(boundary.goals.x1, goals.x1);
    goals.normal0 = of_proxy(boundary.goals.normal0);
    goals.normal1 = of_proxy(boundary.goals.normal1);
}

/// Leaves in m_x where the proxy shows the fine garment.
StepReport EmbeddedStepper::step_proxy(const Boundary& boundary, double dt,
                                       const ClothState& state) {
    take_boundary(boundary);
    ClothState next = m_state;
    next.time = state.time;
    StepReport report = m_stepper->step(m_proxy_boundary, dt, next);
    m_outside.obstacles = std::move(m_proxy_boundary.obstacles);
    if (!report.finite) return report;
    m_state = std::move(next);
    m_offset *= m_settings.fade > 0.0 ? std::exp(-dt / m_settings.fade) : 0.0;
    m_places.positions(m_state.x, m_embedded);
    m_x = m_embedded + m_offset;
    place_pins(*m_fine, boundary, m_x);
    return report;
}

StepReport EmbeddedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_fine, state, boundary, dt)) return StepReport::failed();
    if (same_points(state.x, m_shown.x))
        push(state.v);
    else
        derive(state);
    StepReport report = step_proxy(boundary, dt, state);
    if (!report.finite) return report;
    ClothState next = state;
    if (m_x.allFinite()) show(boundary, dt, next, report);
    next.v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !next.v.allFinite()) {
        m_shown = {};
        return StepReport::failed();
    }
    next.x = m_x;
    next.time += dt;
    state = std::move(next);
    m_shown = state;
    return report;
}

bool EmbeddedStepper::shown_from(const Boundary& boundary, double dt, const ClothState& state,
                                 Points& x) {
    if (!is_valid_step(*m_fine, state, boundary, dt)) return false;
    m_state = {};  // what it remembers of friction, too
    derive(state);
    m_shown = {};  // what comes next is derived, too
    if (!step_proxy(boundary, dt, state).finite || !m_x.allFinite()) return false;
    x = m_x;
    return true;
}

/// Puts into m_outside the limbs that the fine vertices pass over: their own, and those of the
/// proxy around them. One too many shows cloth inside a limb, where the proxy is, too; one too few
/// pushes cloth to the limb's far side.
void EmbeddedStepper::take_ignored(const Boundary& boundary) {
    spread_limbs(m_places, m_stepper->ignored_limbs(), m_ignored);
    if (m_ignored.empty()) return;
    for (size_t i = 0; i < m_ignored.size(); ++i)
        m_ignored[i] |= cloth::ignored_limbs(boundary, static_cast<int>(i));
    m_outside.ignored_limbs = m_ignored;
}

/// Detail is less than an edge of the proxy, or than what faded to m_offset. What goes farther has
/// come to another side of a body than the proxy, where it would be held.
void EmbeddedStepper::limit_detail() {
    for (Eigen::Index i = 0; i < m_x.rows(); ++i) {
        const Vec3 detail = m_x.row(i) - m_embedded.row(i);
        const double length = detail.norm();
        const double most = std::max(m_most_detail, m_offset.row(i).norm());
        m_offset.row(i) = (length > most ? most / length : 1.0) * detail;
        if (length > most) m_x.row(i) = m_embedded.row(i) + m_offset.row(i);
    }
}

/// The fine garment's own step from m_x. What it adds is kept for the next one. One that fails
/// leaves m_x as the proxy shows it.
void EmbeddedStepper::add_detail(double dt, ClothState& state, StepReport& report) {
    StepReport own;
    const StepEnd contacts = report.substeps > 1 ? StepEnd::end : StepEnd::start;
    if (!m_detail->go_on_from(m_x, contacts, m_outside, dt, state, own)) return;
    limit_detail();
    report.iterations += own.iterations;
    report.prediction_rejected = report.prediction_rejected || own.prediction_rejected;
    report.times.proximity += own.times.proximity;
    report.times.features += own.times.features;
    report.times.solve += own.times.solve;
}

/// Where the fine garment is at the end of the step, and what the report says of it.
void EmbeddedStepper::show(const Boundary& boundary, double dt, ClothState& state,
                           StepReport& report) {
    take_ignored(boundary);
    if (m_detail) add_detail(dt, state, report);
    Stopwatch watch;
    m_goal_projection.begin_step(boundary.goals);
    const ResolveReport resolved = m_goal_projection.finish(m_contact_projection, m_proximity,
                                                            m_outside, kDistance, m_x, m_contacts);
    if (m_detail) m_detail->end_at(m_x, state);
    report.residual.reset();
    report.max_penetration = resolved.deepest_after();
    report.vertices_beyond_goals = m_goal_projection.last().beyond;
    report.max_goal_excess = m_goal_projection.last().max_excess;
    report.vertices_in_ignored_limbs = 0;
    report.max_ignored_depth = 0.0;
    if (!m_ignored.empty()) measure_ignored(boundary, report);
    report.times.contact += watch.lap();
}

/// Vertices that pass over limbs, and are inside when nothing is passed over, are inside of these.
void EmbeddedStepper::measure_ignored(const Boundary& boundary, StepReport& report) {
    if (boundary.obstacles.empty()) return;
    m_rows.clear();
    for (size_t i = 0; i < m_ignored.size(); ++i)
        if (m_ignored[i] != 0 && !m_fine->is_pinned()[i]) m_rows.push_back(static_cast<int>(i));
    m_proximity.query_rows(m_x, m_rows, boundary, m_contacts, StepEnd::end);
    for (const int i : m_rows) {
        const double depth = -m_contacts.distance[i];
        if (!(depth > 0.0)) continue;
        ++report.vertices_in_ignored_limbs;
        report.max_ignored_depth = std::max(report.max_ignored_depth, depth);
    }
}

}  // namespace cloth
