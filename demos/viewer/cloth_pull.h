#pragma once

#include <vector>

#include "data/core/garment.h"

namespace cloth {

/// A soft pull at a patch of cloth, as a hand drags it.
struct PullSettings {
    double stiffness = 12.0;     ///< force per distance (N/m), 1 to 200
    double radius = 0.04;        ///< of the patch on the cloth at rest (m), 5e-3 to 0.2
    double max_distance = 0.15;  ///< from which on the pull grows no more (m), 0.01 to 1
};

/// A pull at one vertex and the cloth around it, as drives of skinned goals: a force within the
/// step, which all solvers of a potential and XPBD take implicitly, and which never moves cloth by
/// itself.
///
///     const ClothPull pull(garment, vertex);
///     const Garment pulled = garment.with_goals(pull.limits());  // whose stepper is used
///     boundary.goals = pull.goals(state.x, target);               // in each step
class ClothPull {
 public:
    /// @throws ArgumentError if the vertex does not exist or a setting is out of range
    ClothPull(const Garment& garment, int vertex, const PullSettings& settings = {});

    int vertex() const { return m_vertex; }
    const std::vector<int>& patch() const { return m_patch; }  ///< the vertex first
    /// Drives of the patch's vertices; they shrink towards its border, and sum to the stiffness.
    /// Other vertices keep the limits of `own`, which are the garment's. A vertex has one goal, so
    /// in the patch that is the hand's, which goals() keeps within the garment's limits.
    GoalLimits limits(const GoalLimits& own = {}) const;
    /// Goals of a step from x (|V| x 3, m): the whole patch is pulled by as much as its vertex is
    /// away from `target` (m), but not by more than the largest distance.
    /// @param own, skin  the garment's limits and goals: no vertex is pulled out of them
    SkinGoals goals(const Points& x, const Vec3& target, const GoalLimits& own = {},
                    const SkinGoals& skin = {}) const;

 private:
    int m_vertex;
    PullSettings m_settings;
    std::vector<int> m_patch;
    VectorX m_drive;  ///< |V| (1/s^2)
};

}  // namespace cloth
