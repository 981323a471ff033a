#include "gnn/physics/stepper/embedded_stepper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {

namespace {

constexpr double kDistance = 5e-4;  // of fine vertices from obstacles (m), as all steppers keep it

const EmbeddedStepperSettings& checked(const EmbeddedStepperSettings& settings) {
    check_range("EmbeddedStepperSettings.fade", settings.fade, 0.0, 10.0);
    return settings;
}

ContactProjectionSettings projection_of(const EmbeddedStepperSettings& settings) {
    ContactProjectionSettings projection;
    if (!settings.surface) projection.iterations = 0;
    return projection;
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
                                 const EmbeddedStepperSettings& settings)
    : m_fine(&fine),
      m_settings(checked(settings)),
      m_proxy(std::move(proxy)),
      m_stepper(std::move(stepper)),
      m_places(given(m_proxy, fine).rest(), fine.rest(), settings.embedding),
      m_proxy_places(fine.rest(), m_proxy->rest(), settings.embedding),
      m_proximity(settings.proximity),
      m_contact_projection(fine, projection_of(settings)),
      m_goal_projection(fine) {
    if (!m_stepper)
        throw ArgumentError("EmbeddedStepper of " + fine.name(), "the proxy has no stepper",
                            "make one for the proxy, such as by make_cloth()");
    if (m_proxy->pins().empty() != fine.pins().empty() || m_proxy->has_goals() != fine.has_goals())
        throw ArgumentError("EmbeddedStepper of " + fine.name(),
                            "only one of the garment and its proxy has pins, or goals",
                            "make the proxy by make_proxy() or carry_over()");
    find_pins();
}

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
    return m_stepper->name() + "~" + std::to_string(m_proxy->vertex_count());
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

/// The outside of the fine garment as the proxy has it.
void EmbeddedStepper::take_boundary(const Boundary& boundary) {
    m_proxy_boundary = boundary;
    m_proxy_boundary.pin_targets.setZero(static_cast<Eigen::Index>(m_pins.size()), 3);
    for (size_t k = 0; k < m_pins.size(); ++k)
        for (size_t c = 0; c < 3; ++c)
            m_proxy_boundary.pin_targets.row(static_cast<Eigen::Index>(k)) +=
                m_pins[k].weights[static_cast<Eigen::Index>(c)] *
                boundary.pin_targets.row(m_pins[k].pins[c]);
    m_proxy_boundary.accelerations = of_proxy(boundary.accelerations);
    spread_limbs(m_proxy_places, boundary.ignored_limbs, m_proxy_boundary.ignored_limbs);
    m_proxy_boundary.pinched.clear();  // the proxy's stepper finds out itself
    if (!m_fine->has_goals() || boundary.goals.empty()) return;
    SkinGoals& goals = m_proxy_boundary.goals;
    m_proxy_places.positions(boundary.goals.x0, goals.x0);
    m_proxy_places.positions(boundary.goals.x1, goals.x1);
    goals.normal0 = of_proxy(boundary.goals.normal0);
    goals.normal1 = of_proxy(boundary.goals.normal1);
}

StepReport EmbeddedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_fine, state, boundary, dt)) return StepReport::failed();
    if (same_points(state.x, m_shown.x))
        push(state.v);
    else
        derive(state);
    take_boundary(boundary);
    ClothState next = m_state;
    next.time = state.time;
    StepReport report = m_stepper->step(m_proxy_boundary, dt, next);
    if (!report.finite) return report;
    m_state = std::move(next);
    m_offset *= m_settings.fade > 0.0 ? std::exp(-dt / m_settings.fade) : 0.0;
    show(boundary, report);
    const Points v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !v.allFinite()) {
        m_shown = {};
        return StepReport::failed();
    }
    state.x = m_x;
    state.v = v;
    state.time += dt;
    m_shown = state;
    return report;
}

/// The limbs that the fine vertices pass over: their own, and those of the proxy around them. One
/// too many shows cloth inside a limb, where the proxy is, too; one too few pushes cloth to the
/// limb's far side.
const Boundary& EmbeddedStepper::with_ignored(const Boundary& boundary) {
    spread_limbs(m_places, m_stepper->ignored_limbs(), m_ignored);
    if (m_ignored.empty()) return boundary;
    for (size_t i = 0; i < m_ignored.size(); ++i)
        m_ignored[i] |= cloth::ignored_limbs(boundary, static_cast<int>(i));
    m_filtered = boundary;
    m_filtered.ignored_limbs = m_ignored;
    return m_filtered;
}

/// Where the fine garment is at the end of the step, and what the report says of it.
void EmbeddedStepper::show(const Boundary& boundary, StepReport& report) {
    Stopwatch watch;
    m_places.positions(m_state.x, m_x);
    m_x += m_offset;
    place_pins(*m_fine, boundary, m_x);
    if (!m_x.allFinite()) return;
    const Boundary& outside = with_ignored(boundary);
    m_goal_projection.begin_step(boundary.goals);
    const ResolveReport resolved = m_goal_projection.finish(m_contact_projection, m_proximity,
                                                            outside, kDistance, m_x, m_contacts);
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
    VectorX distance;
    m_proximity.signed_distance(m_x, boundary, StepEnd::end, distance);
    for (size_t i = 0; i < m_ignored.size(); ++i) {
        const double depth = -distance[static_cast<Eigen::Index>(i)];
        if (m_ignored[i] == 0 || m_fine->is_pinned()[i] || !(depth > 0.0)) continue;
        ++report.vertices_in_ignored_limbs;
        report.max_ignored_depth = std::max(report.max_ignored_depth, depth);
    }
}

}  // namespace cloth
