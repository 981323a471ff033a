#include "demos/bullet_scenes/scene_meters.h"

#include <algorithm>
#include <cmath>

#include "demos/compare/statistics.h"

namespace cloth {

EnergyWatch::EnergyWatch(const SceneWorld& scene, const btGnnSoftBodySolver* solver,
                         OutsideWork work)
    : m_meter(scene, solver), m_solver(solver), m_work(work) {
    m_shown = m_meter.now().sum();
    if (work == OutsideWork::none) take(m_shown);
}

void EnergyWatch::take(double energy) {
    m_least = m_started ? std::min(m_least, energy) : energy;
    m_rise = std::max(m_rise, energy - m_least);
    m_started = true;
}

void EnergyWatch::step() {
    const double before = m_shown;
    m_shown = m_meter.now().sum();
    if (!m_solver || m_solver->status().clothBodies == 0) {
        take(m_shown);
        return;
    }
    const bool ticked = m_solver->status().steps > m_ticks;
    const bool first = m_ticks == 0;
    m_ticks = m_solver->status().steps;
    if (ticked && !first) take(before);
}

double EnergyWatch::largestRise() const {
    return m_work == OutsideWork::always ? std::numeric_limits<double>::quiet_NaN() : m_rise;
}

SceneMeters::SceneMeters(const SceneRecipe& recipe, const SceneWorld& scene, SceneProbe& probe,
                         const btGnnSoftBodySolver* solver)
    : m_probe(probe), m_energy(scene, solver, recipe.outside_work) {
}

void SceneMeters::step() {
    m_energy.step();
    m_depth = std::max(m_depth, m_probe.deepest());
    m_node_speed = std::max(m_node_speed, m_probe.fastestNode());
    m_body_speed = std::max(m_body_speed, m_probe.fastestBody());
    const std::vector<double> stretches = m_probe.stretches();
    if (stretches.empty()) return;
    const double longest = *std::max_element(stretches.begin(), stretches.end());
    m_stretch_p99 = std::fmax(m_stretch_p99, quantile(stretches, 0.99));
    m_stretch_max = std::fmax(m_stretch_max, longest);
}

void SceneMeters::write(SceneRow& row) const {
    row.energy_rise_j = m_energy.largestRise();
    row.energy_scale_j = m_energy.scale();
    row.penetration_max_mm = 1e3 * m_depth;
    row.stretch_p99 = m_stretch_p99;
    row.stretch_max = m_stretch_max;
    row.node_speed_max = m_node_speed;
    row.body_speed_max = m_body_speed;
}

}  // namespace cloth
