#include "gnn/model/learned_stepper.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "data/core/errors.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {

namespace {

QuasiNewtonSettings refinement(const LearnedStepperSettings& settings) {
    const Refinement& refine = settings.refine;
    if (refine.iterations < 0 || refine.iterations > 1000)
        throw ArgumentError("refine.iterations",
                            std::to_string(refine.iterations) + " is outside 0 to 1000",
                            "use 10, or 0 for the network alone");
    if (refine.least < 0 || refine.least > 1000)
        throw ArgumentError("refine.least", std::to_string(refine.least) + " is outside 0 to 1000",
                            "use 10, or 0 to stop as soon as the tolerance is met");
    if (!(refine.least_gain >= 0.0 && refine.least_gain <= 1.0))
        throw ArgumentError("refine.least_gain",
                            std::to_string(refine.least_gain) + " is outside 0 to 1 m",
                            "use 0 for a fixed number of iterations, or metres such as 0.003");
    if (!(refine.tolerance >= 0.0) || refine.tolerance > 1e6)
        throw ArgumentError("refine.tolerance",
                            std::to_string(refine.tolerance) + " is outside 0 to 1e6",
                            "use 0 for a fixed number of iterations, or a residual such as 1");
    QuasiNewtonSettings solver;
    solver.iterations = settings.refine.iterations;
    solver.least_iterations = settings.refine.least;
    solver.tolerance = settings.refine.tolerance;
    solver.least_gain = settings.refine.least_gain;
    solver.potential = settings.potential;
    return solver;
}

}  // namespace

LearnedStepper::LearnedStepper(const Garment& garment, std::shared_ptr<Predictor> predictor,
                               LearnedStepperSettings settings)
    : m_garment(&garment),
      m_predictor(std::move(predictor)),
      m_settings(settings),
      m_graph(build_cloth_graph(garment, m_predictor->config().graph_settings())),
      m_proximity(settings.proximity),
      m_ridges(garment),
      m_resolver(garment),
      m_layers(garment, settings.potential.self_contact),
      m_potential(garment, settings.potential),
      m_time(settings.potential.integrator),
      m_solver(garment, refinement(settings)),
      m_builder(garment, m_graph, m_predictor->config().features) {
}

std::string LearnedStepper::name() const {
    const Refinement& refine = m_settings.refine;
    if (refine.least_gain > 0.0) return m_predictor->config().variant;
    char text[32];
    if (refine.tolerance > 0.0)
        std::snprintf(text, sizeof text, "+%.0e", refine.tolerance);
    else
        std::snprintf(text, sizeof text, "+%d", refine.iterations);
    return m_predictor->config().variant + text;
}

StepReport LearnedStepper::step(const Boundary& boundary, double dt, ClothState& state) {
    StepReport report;
    if (!is_valid_step(*m_garment, state, boundary, dt)) {
        report.finite = false;
        return report;
    }
    Stopwatch watch;
    m_proximity.query(state.x, boundary, m_contacts);
    m_ridges.find(m_proximity, boundary, state.x, m_contacts);
    report.times.proximity = watch.lap();
    predict(boundary, dt, state, report);
    watch.lap();
    refine(report);
    report.times.solve += watch.lap();
    report.finite = accept(boundary, dt, state, report);
    report.times.contact = watch.lap();
    return report;
}

void LearnedStepper::predict(const Boundary& boundary, double dt, const ClothState& state,
                             StepReport& report) {
    Stopwatch watch;
    const double contact_distance = m_settings.potential.contact_distance;
    const InertialStep* inertia = m_time.begin_step(state, m_contacts, contact_distance, dt);
    m_potential.begin_step(state, boundary, m_contacts, dt, inertia);
    starting_guess(*m_garment, state, boundary, m_contacts, dt, contact_distance, m_guess);
    m_potential.separate_self_contact(m_guess);
    m_builder.build(state, boundary, m_potential, m_guess, m_features);
    report.times.features = watch.lap();
    m_predictor->predict(m_graph, m_features, m_output);
    m_fell_back = m_output.rows() != m_guess.rows() || !m_output.allFinite();
    m_prediction = m_guess;
    if (!m_fell_back) m_prediction += m_features.scale * m_output;
    place_pins(*m_garment, boundary, m_prediction);
    if (m_settings.refine.iterations > 0) check_prediction();
    report.times.solve = watch.lap();
}

void LearnedStepper::check_prediction() {
    if (m_fell_back || m_potential.value(m_prediction) <= m_potential.value(m_guess)) return;
    m_fell_back = true;
    m_prediction = m_guess;
}

void LearnedStepper::refine(StepReport& report) {
    m_x = m_prediction;
    report.residual = std::numeric_limits<double>::quiet_NaN();
    if (m_settings.refine.iterations == 0) return;
    const MinimiseReport minimum = m_solver.minimise(m_potential, m_x);
    report.iterations = minimum.iterations;
    report.residual = minimum.residual;
    report.gain = minimum.gain;
    report.converged = minimum.converged;
}

bool LearnedStepper::accept(const Boundary& boundary, double dt, ClothState& state,
                            StepReport& report) {
    if (!m_x.allFinite()) return false;
    place_pins(*m_garment, boundary, m_x);
    const ResolveReport resolved =
        m_resolver.resolve(m_proximity, boundary, m_settings.safety_distance, m_x, m_resolved);
    if (!m_x.allFinite()) return false;
    report.max_penetration = resolved.deepest_after();
    report.max_entry = resolved.max_depth_before;
    m_layers.finish(state.x, m_proximity, boundary, m_settings.safety_distance, m_x, m_resolved,
                    report);
    m_v = (m_x - state.x) / dt;
    if (!m_x.allFinite() || !m_v.allFinite()) return false;  // very short steps overflow
    m_time.end_step(state, m_x, m_v, dt);
    state.x = m_x;
    state.v = m_v;
    state.time += dt;
    return true;
}

}  // namespace cloth
