#pragma once

#include <vector>

#include "data/core/boundary.h"

namespace cloth {

/// What follows the vertices of a garment that is simulated, such as a finer mesh to be drawn. See
/// EmbeddedMesh, and btGnnSoftBodySolver::follow().
class Follower {
 public:
    virtual ~Follower() = default;

    /// Number of the vertices that it follows.
    virtual Eigen::Index simulated_size() const = 0;

    /// @param simulated  where they are now (simulated_size() x 3, m)
    /// @param boundary   obstacles; those at the end of its step are where they are now
    /// @param ignored    limbs that each vertex ignores, see Stepper::ignored_limbs(), or empty
    virtual void show(const Points& simulated, const Boundary& boundary,
                      const std::vector<LimbSet>& ignored) = 0;
};

}  // namespace cloth
