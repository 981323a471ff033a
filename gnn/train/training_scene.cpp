#include "gnn/train/training_scene.h"

#include <utility>

#include "collision/response/resolve.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {

static ProximitySettings single_threaded() {
    ProximitySettings settings;
    settings.threads = 1;
    return settings;
}

/// Small steps of the proxy, single-threaded and never cut, so that they depend on the state alone.
static std::unique_ptr<EmbeddedStepper> embedded(const SceneParts& parts) {
    if (!parts.proxy) return nullptr;
    ClothStepperSettings settings;
    settings.step.proximity = single_threaded();
    settings.guard = GuardSettings::off();
    EmbeddedStepperSettings shown;
    shown.proximity = single_threaded();
    return std::make_unique<EmbeddedStepper>(
        *parts.garment, parts.proxy, std::make_unique<ClothStepper>(*parts.proxy, settings), shown);
}

TrainingScene::TrainingScene(SceneParts parts, const FeatureSettings& features, double dt)
    : state(parts.start),
      m_parts(std::move(parts)),
      m_dt(dt),
      m_proximity(single_threaded()),
      m_potential(*m_parts.garment),
      m_solver(*m_parts.garment),
      m_builder(*m_parts.garment, *m_parts.graph, features),
      m_laplacian(cotangent_laplacian(m_parts.garment->rest())),
      m_proxy(embedded(m_parts)) {
}

void TrainingScene::prepare(double contact_weight) {
    m_parts.world->boundary(state.time, m_dt, m_boundary);
    m_potential.set_contact_weight(contact_weight);
    if (!start_at_proxy()) start_at_guess();
    m_builder.build(state, m_boundary, m_potential, m_guess, m_features);
}

void TrainingScene::start_at_guess() {
    m_proximity.query(state.x, m_boundary, m_contacts);
    m_potential.begin_step(state, m_boundary, m_contacts, m_dt);
    starting_guess(garment(), state, m_boundary, m_contacts, m_dt,
                   m_potential.settings().contact_distance, m_guess);
}

/// As StepSolver::go_on_from() does. False: there is no proxy, or its step failed.
bool TrainingScene::start_at_proxy() {
    if (!m_proxy || !m_proxy->shown_from(m_boundary, m_dt, state, m_guess)) return false;
    m_proximity.query(state.x, m_boundary, m_contacts);
    m_potential.begin_step(state, m_boundary, m_contacts, m_dt);
    project_out(m_contacts, m_potential.settings().contact_distance, m_guess);
    place_pins(garment(), m_boundary, m_guess);
    return true;
}

double TrainingScene::refine(Points& x, int iterations) {
    return m_solver.minimise(m_potential, x, IterationLimits::exactly(iterations)).energy;
}

bool TrainingScene::is_sound(const Points& x) const {
    if (!x.allFinite()) return false;
    const Points& rest = garment().rest().vertices;
    double sum = 0.0;
    for (const auto& [a, b] : garment().edges()) {
        const double stretch = (x.row(a) - x.row(b)).norm() / (rest.row(a) - rest.row(b)).norm();
        if (stretch > 3.0) return false;
        sum += stretch;
    }
    return sum < 1.5 * static_cast<double>(garment().edges().size());
}

bool TrainingScene::advance(const Points& x) {
    if (!is_sound(x)) return false;
    state.v = (x - state.x) / m_dt;
    state.x = x;
    state.time += m_dt;
    ++age;
    return true;
}

void TrainingScene::warm_up(int iterations, double contact_weight) {
    for (int frame = 0; frame < m_parts.warm_up; ++frame) {
        prepare(contact_weight);
        Points x = m_features.base;
        refine(x, iterations);
        if (!advance(x)) break;
    }
    age = 0;
}

}  // namespace cloth
