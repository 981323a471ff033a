#pragma once

#include <memory>
#include <string>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "demos/bullet_scenes/worlds/scenes.h"

namespace cloth {

/// Makes soft body solvers by name: "bullet" is Bullet's own (null), "default" is make_cloth() as
/// it comes, "quasi-newton-K" steps cloth with K iterations at the world's rate, "xpbd-N" with N
/// sub-steps, everything else is a network NAME or NAME+K of the folder of weights (empty: the
/// committed ones), safeguarded as it ships.
class SceneSolvers {
 public:
    explicit SceneSolvers(std::string weights = "") : m_weights(std::move(weights)) {}

    /// A solver for one world. @throws UsageError or LoadError naming what is wrong
    std::unique_ptr<btGnnSoftBodySolver> make(const std::string& name,
                                              const btGnnSolverSettings& settings = {}) const;

 private:
    std::string m_weights;
};

/// Bullet's demos run with the solver's defaults: as their bodies say. The small scenes are of soft
/// cotton, which the networks know, with Coulomb's friction.
btGnnSolverSettings defaults_of(const SceneRecipe& recipe);

}  // namespace cloth
