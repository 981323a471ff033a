#pragma once

#include <limits>

#include "demos/bullet_scenes/scene_probe.h"
#include "demos/bullet_scenes/scene_run.h"
#include "demos/bullet_scenes/total_energy.h"

namespace cloth {

/// Follows the total energy of a scene: how far it is above the least it was before.
///
/// Between two ticks of a network positions and velocities of the nodes are interpolated, and their
/// energy is no state's. So it counts where cloth steps end.
class EnergyWatch {
 public:
    EnergyWatch(const SceneWorld& scene, const btGnnSoftBodySolver* solver, OutsideWork work);

    /// After each step of the world.
    void step();
    /// Largest rise (J) without outside work so far; NaN if there is always some.
    double largestRise() const;
    double scale() const { return m_meter.scale(); }

 private:
    void take(double energy);

    TotalEnergyMeter m_meter;
    const btGnnSoftBodySolver* m_solver;
    OutsideWork m_work;
    long m_ticks = 0;
    double m_shown = 0.0;  ///< after the last step of the world (J)
    double m_least = 0.0, m_rise = 0.0;
    bool m_started = false;
};

/// What is measured after each step of a scene.
class SceneMeters {
 public:
    SceneMeters(const SceneRecipe& recipe, const SceneWorld& scene, SceneProbe& probe,
                const btGnnSoftBodySolver* solver);

    void step();
    /// Figures of all steps so far.
    void write(SceneRow& row) const;

 private:
    SceneProbe& m_probe;
    EnergyWatch m_energy;
    double m_depth = 0.0;
    double m_stretch_p99 = std::numeric_limits<double>::quiet_NaN();  ///< no links
    double m_stretch_max = std::numeric_limits<double>::quiet_NaN();
    double m_node_speed = 0.0, m_body_speed = 0.0;
};

}  // namespace cloth
