#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "data/core/mesh.h"
#include "demos/bullet_scenes/scene_energy.h"
#include "demos/bullet_scenes/scene_solver.h"
#include "demos/bullet_scenes/step_lengths.h"
#include "demos/bullet_scenes/worlds/scenes.h"

namespace cloth {

/// How a scene is run.
struct SceneRunSettings {
    std::string solver = "small";  ///< a name of SceneSolvers
    StepPlan steps;
    double seconds = 10.0;
    int pictures_per_second = 0;  ///< 0: nothing is recorded
};

/// What is to be drawn of one moment: surfaces in the world's frame (m).
struct ScenePicture {
    std::vector<TriMesh> rigid, cloth, others;
};

/// What a run shows. Numbers that a scene has no meaning for are NaN.
struct SceneRow {
    std::string scene, solver;
    int rate_hz = 0;                  ///< 0: random steps
    int cloth_bodies = 0;             ///< stepped by our solver at the end, not by Bullet
    bool finite = false;              ///< all nodes and bodies, to the end
    double rest_error_mm = 0.0;       ///< RMS distance of the last shape to the reference's
    double rest_energy_mm = 0.0;      ///< the last shape's stretch, bending and gravity energy over
                                      ///< the cloth's weight, less the reference's
    double speed_end_mm_s = 0.0;      ///< RMS speed of the cloth after the last step
    double momentum_error = 0.0;      ///< of the closed twin: |p(t) - p(0)| / |p(0)| at its end
    double penetration_max_mm = 0.0;  ///< deepest cloth node inside a solid, all steps
    double energy_rise_j = 0.0;       ///< most that TotalEnergy was above what it was before
    double energy_scale_j = 0.0;      ///< see TotalEnergyMeter::scale()
    double stretch_p99 = 0.0;     ///< length over rest length that 1 % of the links exceed, and of
    double stretch_max = 0.0;     ///< the longest one, of the worst step
    double node_speed_max = 0.0;  ///< (m/s), all steps
    double body_speed_max = 0.0;
    double ms_mean = 0.0, ms_worst = 0.0;  ///< of a stepSimulation(), all steps
    double times_bullet = 0.0;             ///< ms_mean over that of Bullet's solver
    double ms_median = 0.0;  ///< wall time of a stepSimulation(), mean of each 1/30 s: steps
                             ///< between two ticks of a network cost nothing
    double ms_median_last_second = 0.0;  ///< the same, when what can sleep sleeps
};

struct SceneResult {
    SceneRow row;
    std::vector<Points> last;    ///< of each cloth (|V| x 3, m)
    std::vector<Points> others;  ///< of the other soft bodies
    SceneEnergy energy;          ///< then
    std::vector<ScenePicture> pictures;
    std::vector<std::string> messages;  ///< of our solver
};

using SceneProgress = std::function<void(int done, int all)>;

/// Runs the scene for its time; what needs a reference is left NaN.
SceneResult run_scene(const SceneRecipe& recipe, const SceneRunSettings& settings,
                      const SceneSolvers& solvers, const SceneProgress& progress = {});

/// RMS distance between two last shapes (mm); NaN if their sizes differ or there is none.
double shape_distance_mm(const std::vector<Points>& a, const std::vector<Points>& b);

/// How much more energy the cloth has in `a` than in `b`, over its weight: the height (mm) that its
/// weight would have to be lifted by.
double energy_distance_mm(const SceneEnergy& a, const SceneEnergy& b);

/// Runs the scene's closed twin for a second: how much of the momentum was lost or made, relative
/// to what there was. NaN if the scene has none.
double momentum_error(const SceneRecipe& recipe, const SceneRunSettings& settings,
                      const SceneSolvers& solvers);

}  // namespace cloth
