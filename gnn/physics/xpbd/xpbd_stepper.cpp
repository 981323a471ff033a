#include "gnn/physics/xpbd/xpbd_stepper.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "data/core/check_range.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

// Planes hold cloth at the contact distance; what ends closer than this has left the part of the
// surface that its plane stands for and is moved by contact projection.
constexpr double safety_distance = 5e-4;  // m

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

const XpbdSettings& checked(const XpbdSettings& settings) {
    check_range("XpbdSettings.substeps", settings.substeps, 1, 1000);
    check_range("XpbdSettings.iterations", settings.iterations, 1, 100);
    check_range("XpbdSettings.relaxation", settings.relaxation, 1.0, 1.3);
    check_range("XpbdSettings.damping", settings.damping, 0.0, 10.0);
    check_range("XpbdSettings.bending_angle", settings.bending_angle, 0.01, 1.5);
    check_range("XpbdSettings.contact_distance", settings.contact_distance, safety_distance, 1e-2);
    return settings;
}

}  // namespace

XpbdStepper::XpbdStepper(const Garment& garment, const XpbdSettings& settings,
                         const ProximitySettings& proximity)
    : m_garment(&garment),
      m_settings(checked(settings)),
      m_stretch(stretch_springs(garment), garment.mobilities(), settings.relaxation),
      m_bending(bending_springs(garment, settings.bending_angle), garment.mobilities(),
                settings.relaxation),
      m_proximity(proximity),
      m_resolver(garment),
      m_goal_resolver(garment),
      m_goals(garment),
      m_self_planes(garment, settings.self_contact),
      m_self_contact(garment, settings.self_contact) {
}

std::string XpbdStepper::name() const {
    return "xpbd-" + std::to_string(m_settings.substeps);
}

StepReport XpbdStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt)) return StepReport::failed();
    StepReport report;
    const Clock::time_point begin = Clock::now();
    find_contacts(boundary, state);
    report.times.proximity = milliseconds_since(begin);

    const Clock::time_point solve = Clock::now();
    start(boundary, dt, state);
    run(boundary, dt, state.x);
    report.iterations = m_settings.substeps * m_settings.iterations;
    report.times.solve = milliseconds_since(solve);

    const Clock::time_point contact = Clock::now();
    resolve(boundary, dt, report);
    if (m_settings.self_contact.on()) finish_self_contact(boundary, dt, state, report);
    m_self_contact.count_tangles(m_x, boundary.overlapped, report);
    if (m_garment->has_goals()) finish_goals(dt, state, report);
    report.times.contact = milliseconds_since(contact);
    report.finite = finish(dt, state);
    if (!report.finite) return StepReport::failed();
    m_self_contact.untangle({boundary, m_proximity, m_goal_resolver, safety_distance, m_contacts},
                            dt, state, report);
    m_last_x = state.x;
    return report;
}

/// Replaces the state, or leaves it if a number is not finite.
bool XpbdStepper::finish(double dt, ClothState& state) {
    m_v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !m_v.allFinite() || !m_w.allFinite()) return false;
    m_lag = m_w.leftCols<3>() - m_v;
    state.x = m_last_x = m_x;
    state.v = m_v;
    state.stick = {};
    state.time += dt;
    return true;
}

void XpbdStepper::find_contacts(const Boundary& boundary, const ClothState& state) {
    if (boundary.obstacles.empty())
        m_contacts.clear();
    else
        m_proximity.query(state.x, boundary, m_contacts);
}

/// The velocities from which the substeps go on.
void XpbdStepper::start(const Boundary& boundary, double dt, const ClothState& state) {
    const double h = dt / m_settings.substeps;
    if (dt != m_prepared_dt) m_stretch.set_time_step(h), m_bending.set_time_step(h);
    m_prepared_dt = dt;
    m_planes.begin_step(*m_garment, state.x, boundary, m_contacts, m_settings.contact_distance,
                        m_settings.substeps);
    m_self_planes.begin_step(state, dt, m_self_contact.begin_step(state.x, boundary.overlapped));
    m_goals.begin_step(boundary.goals, dt, m_settings.substeps);
    m_w.setZero(state.x.rows(), 4);
    m_w.leftCols<3>() = state.v;
    if (same_points(state.x, m_last_x))
        m_w.leftCols<3>() += m_lag;
    else
        estimate_lag(boundary, dt, state);
}

/// Of a constant acceleration a, N substeps from the velocity v + (N - 1) / 2N a dt have the mean
/// velocity v + a dt.
void XpbdStepper::estimate_lag(const Boundary& boundary, double dt, const ClothState& state) {
    run(boundary, dt, state.x);
    const double share = 0.5 * (m_settings.substeps - 1) / m_settings.substeps;
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        Vec3 acceleration = boundary.gravity;
        if (boundary.accelerations.rows() > 0)
            acceleration += boundary.accelerations.row(i).transpose();
        const Vec3 lag = share * (m_w.row(i).head<3>() - state.v.row(i));
        const double length = lag.norm(), most = share * dt * acceleration.norm();
        m_w.row(i).head<3>() = state.v.row(i);
        m_w.row(i).head<3>() += (length > most ? most / length : 1.0) * lag.transpose();
    }
}

void XpbdStepper::run(const Boundary& boundary, double dt, const Points& x0) {
    m_p.setZero(x0.rows(), 4);
    m_p.leftCols<3>() = x0;
    for (int index = 1; index <= m_settings.substeps; ++index) {
        m_planes.begin_substep(index);
        m_planes.recover(m_p);
        m_before = m_p;
        move_freely(boundary, dt / m_settings.substeps);
        m_goals.begin_substep(index);
        m_goals.drive(m_before, m_p);
        m_goals.project(m_p);
        move_pins(boundary, x0, static_cast<double>(index) / m_settings.substeps);
        for (int k = 0; k < m_settings.iterations; ++k) {
            m_stretch.relax(m_p, k == 0);
            m_bending.relax(m_p, k == 0);
            m_self_planes.project(m_before, m_p);
            m_goals.project(m_p);
            m_planes.project(m_before, m_p);
        }
        m_w = (m_settings.substeps / dt) * (m_p - m_before);
    }
    m_x = m_p.leftCols<3>();
}

void XpbdStepper::move_freely(const Boundary& boundary, double h) {
    const Eigen::RowVector4d gravity(boundary.gravity.x(), boundary.gravity.y(),
                                     boundary.gravity.z(), 0.0);
    m_w.rowwise() += h * gravity;
    if (boundary.accelerations.rows() > 0) m_w.leftCols<3>() += h * boundary.accelerations;
    m_w *= std::exp(-m_settings.damping * h);
    m_p += h * m_w;
}

void XpbdStepper::move_pins(const Boundary& boundary, const Points& x0, double progress) {
    for (size_t k = 0; k < m_garment->pins().size(); ++k) {
        const int pin = m_garment->pins()[k];
        const auto target = boundary.pin_targets.row(static_cast<Eigen::Index>(k));
        m_p.row(pin).head<3>() = x0.row(pin) + progress * (target - x0.row(pin));
    }
}

/// Vertices that self-contact projection moved go on with their mean velocity.
void XpbdStepper::finish_self_contact(const Boundary& boundary, double dt, const ClothState& state,
                                      StepReport& report) {
    m_v = m_x;
    m_self_contact.finish(state.x,
                          {boundary, m_proximity, m_goal_resolver, safety_distance, m_contacts},
                          m_x, report);
    for (Eigen::Index i = 0; i < m_x.rows(); ++i)
        if (m_x.row(i) != m_v.row(i)) m_w.row(i).head<3>() = (m_x.row(i) - state.x.row(i)) / dt;
}

/// Vertices that goals moved after the last substep go on with their mean velocity.
void XpbdStepper::finish_goals(double dt, const ClothState& state, StepReport& report) {
    for (const int i : m_goal_resolver.moved())
        m_w.row(i).head<3>() = (m_x.row(i) - state.x.row(i)) / dt;
    report.vertices_beyond_goals = m_goal_resolver.last().beyond;
    report.max_goal_excess = m_goal_resolver.last().max_excess;
}

/// Contact projection; vertices that it moved keep no velocity into the surface.
void XpbdStepper::resolve(const Boundary& boundary, double dt, StepReport& report) {
    place_pins(*m_garment, boundary, m_x);
    m_goal_resolver.begin_step(boundary.goals);
    const ResolveReport resolved =
        m_goal_resolver.finish(m_resolver, m_proximity, boundary, safety_distance, m_x, m_contacts);
    report.max_penetration = resolved.deepest_after();
    report.max_entry = resolved.max_depth_before;
    for (size_t k = 0; k < m_contacts.obstacle.size(); ++k) {
        const Eigen::Index i = static_cast<Eigen::Index>(k);
        if (!m_contacts.has(i) || m_x.row(i) == m_p.row(i).head<3>()) continue;
        const Vec3 normal = m_contacts.normal1.row(i);
        auto velocity = m_w.row(i).head<3>();
        const double inward = normal.dot(velocity.transpose() - m_contacts.velocity(i, dt));
        if (inward < 0.0) velocity -= inward * normal.transpose();
    }
}

}  // namespace cloth
