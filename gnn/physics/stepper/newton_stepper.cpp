#include "gnn/physics/stepper/newton_stepper.h"

#include <chrono>
#include <cmath>
#include <string>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

StepReport failed() {
    StepReport report;
    report.finite = false;
    return report;
}

}  // namespace

NewtonStepper::NewtonStepper(const Garment& garment, const NewtonStepperSettings& settings)
    : m_garment(&garment),
      m_settings(settings),
      m_potential(garment, settings.potential),
      m_time(settings.potential.integrator),
      m_newton(garment, settings),
      m_proximity(settings.proximity),
      m_ridges(garment),
      m_resolver(garment),
      m_layers(garment, settings.potential.self_contact) {
    if (settings.contact_updates < 0 || settings.contact_updates > 10)
        throw ArgumentError("NewtonStepperSettings.contact_updates",
                            std::to_string(settings.contact_updates) + " is out of range",
                            "choose 0 to 10");
}

StepReport NewtonStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt)) return failed();
    StepReport report;
    if (!minimise(boundary, state, dt, report)) return failed();
    finish(boundary, report);
    m_layers.finish(state.x, m_proximity, boundary, std::max(0.0, m_settings.safety_distance), m_x,
                    m_contacts, report);
    m_v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !m_v.allFinite()) return failed();
    m_time.end_step(state, m_x, m_v, dt);
    state.x = m_x;
    state.v = m_v;
    state.time += dt;
    return report;
}

bool NewtonStepper::minimise(const Boundary& boundary, const ClothState& state, double dt,
                             StepReport& report) {
    for (int round = 0; round <= m_settings.contact_updates; ++round) {
        const Clock::time_point start = Clock::now();
        if (round == 0)
            find_contacts(boundary, state.x, StepEnd::start);
        else
            find_contacts(boundary, m_x, StepEnd::end);
        report.times.proximity += milliseconds_since(start);

        const Clock::time_point solve = Clock::now();
        const InertialStep* inertia =
            m_time.begin_step(state, m_contacts, m_potential.settings().contact_distance, dt);
        m_potential.begin_step(state, boundary, m_contacts, dt, inertia);
        if (round == 0) choose_start(boundary, state, dt);
        const MinimiseReport minimum = m_newton.minimise(m_potential, m_x);
        report.times.solve += milliseconds_since(solve);
        if (!minimum.finite) return false;
        report.iterations += minimum.iterations;
        report.residual = minimum.residual;
        report.converged = minimum.converged;
        if (boundary.obstacles.empty()) break;
    }
    return true;
}

void NewtonStepper::find_contacts(const Boundary& boundary, const Points& x, StepEnd end) {
    if (boundary.obstacles.empty()) {
        m_contacts.clear();
        return;
    }
    m_proximity.query(x, boundary, m_contacts, end);
    m_ridges.find(m_proximity, boundary, x, m_contacts, end);
}

void NewtonStepper::choose_start(const Boundary& boundary, const ClothState& state, double dt) {
    starting_guess(*m_garment, state, boundary, m_contacts, dt,
                   m_potential.settings().contact_distance, m_x);
    m_potential.separate_self_contact(m_x);
    if (std::isfinite(m_potential.value(m_x))) return;
    m_x = state.x;
    place_pins(*m_garment, boundary, m_x);
}

void NewtonStepper::finish(const Boundary& boundary, StepReport& report) {
    place_pins(*m_garment, boundary, m_x);
    if (boundary.obstacles.empty()) return;
    const Clock::time_point start = Clock::now();
    if (m_settings.safety_distance >= 0.0) {
        const ResolveReport resolved =
            m_resolver.resolve(m_proximity, boundary, m_settings.safety_distance, m_x, m_contacts);
        report.max_penetration = resolved.deepest_after();
        report.max_entry = resolved.max_depth_before;
    } else {
        m_proximity.signed_distance(m_x, boundary, StepEnd::end, m_distance);
        report.max_entry = report.max_penetration = std::max(0.0, -m_distance.minCoeff());
    }
    report.times.contact = milliseconds_since(start);
}

}  // namespace cloth
