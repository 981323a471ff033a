#pragma once

#include <memory>
#include <string>

#include "bullet_ext/btGnnSoftBodySolver.h"

namespace cloth {

/// Makes soft body solvers by name: "bullet" is Bullet's own (null), "quasi-newton-K" steps cloth
/// with K iterations at the world's rate, everything else is a network NAME or NAME+K of the folder
/// of weights (empty: the committed ones), safeguarded as it ships.
class SceneSolvers {
 public:
    explicit SceneSolvers(std::string weights = "") : m_weights(std::move(weights)) {}

    /// A solver for one world. @throws UsageError or LoadError naming what is wrong
    std::unique_ptr<btGnnSoftBodySolver> make(const std::string& name) const;

 private:
    std::string m_weights;
};

}  // namespace cloth
