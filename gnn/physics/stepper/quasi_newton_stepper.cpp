#include "gnn/physics/stepper/quasi_newton_stepper.h"

#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {
namespace {

// The contact energy keeps cloth at the contact distance; what ends closer than this was missed by
// it (a vertex that left the plane of its face) and is moved by contact projection.
constexpr double safety_distance = 5e-4;  // m

StepReport failed() {
    StepReport report;
    report.finite = false;
    return report;
}

}  // namespace

QuasiNewtonStepper::QuasiNewtonStepper(const Garment& garment, const QuasiNewtonSettings& settings,
                                       const ProximitySettings& proximity)
    : m_garment(&garment),
      m_potential(garment, settings.potential),
      m_time(settings.potential.integrator),
      m_solver(garment, settings),
      m_proximity(proximity),
      m_ridges(garment),
      m_resolver(garment),
      m_layers(garment, settings.potential.self_contact) {
}

std::string QuasiNewtonStepper::name() const {
    const QuasiNewtonSettings& settings = m_solver.settings();
    std::string name = "quasi-newton";
    if (settings.tolerance == 0.0 && settings.least_gain == 0.0)
        name += "-" + std::to_string(settings.iterations);
    if (settings.potential.integrator == Integrator::bdf2) name += "-bdf2";
    return name;
}

StepReport QuasiNewtonStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    if (!is_valid_step(*m_garment, state, boundary, dt)) return failed();
    StepReport report;
    Stopwatch watch;
    find_contacts(boundary, state);
    report.times.proximity = watch.lap();

    const double contact_distance = m_potential.settings().contact_distance;
    const InertialStep* inertia = m_time.begin_step(state, m_contacts, contact_distance, dt);
    m_potential.begin_step(state, boundary, m_contacts, dt, inertia);
    starting_guess(*m_garment, state, boundary, m_contacts, dt, contact_distance, m_x);
    m_potential.separate_self_contact(m_x);
    const MinimiseReport minimum = m_solver.minimise(m_potential, m_x);
    if (!minimum.finite) return failed();
    report.iterations = minimum.iterations;
    report.residual = minimum.residual;
    report.gain = minimum.gain;
    report.converged = minimum.converged;
    report.times.solve = watch.lap();

    resolve(boundary, report);
    m_layers.finish(state.x, m_proximity, boundary, safety_distance, m_x, m_contacts, report);
    report.times.contact = watch.lap();
    m_v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !m_v.allFinite()) return failed();
    m_time.end_step(state, m_x, m_v, dt);
    state.x = m_x;
    state.v = m_v;
    state.time += dt;
    return report;
}

void QuasiNewtonStepper::find_contacts(const Boundary& boundary, const ClothState& state) {
    if (boundary.obstacles.empty()) {
        m_contacts.clear();
        return;
    }
    m_proximity.query(state.x, boundary, m_contacts);
    m_ridges.find(m_proximity, boundary, state.x, m_contacts);
}

void QuasiNewtonStepper::resolve(const Boundary& boundary, StepReport& report) {
    place_pins(*m_garment, boundary, m_x);
    const ResolveReport resolved =
        m_resolver.resolve(m_proximity, boundary, safety_distance, m_x, m_contacts);
    report.max_penetration = resolved.deepest_after();
    report.max_entry = resolved.max_depth_before;
}

}  // namespace cloth
