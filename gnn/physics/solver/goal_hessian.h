#pragma once

#include <vector>

#include "gnn/physics/energy/goal_energy.h"

namespace cloth {

/// What skinned goals add to the constant matrix of the quasi-Newton method: a symmetric positive
/// semi-definite block (N/m) for each vertex that is driven, or beyond a limit. As for contact, a
/// vertex that a plain step would take beyond a limit gets the stiffness of where it is heading,
/// and a trial point is never much farther beyond than the point it comes from.
class GoalHessian {
 public:
    struct Block {
        int row;  ///< of the free vertices
        Eigen::Matrix3d stiffness;
    };

    /// @param row_of  |V|: free row, -1 for a pin
    void begin_step(const GoalEnergy& energy, const std::vector<int>& row_of);
    /// Linearises at x (|V| x 3).
    void linearise(const Points& x);
    /// Stiffens what `step` (free, n x 3) would take beyond a limit.
    void anticipate(const Points& step);
    /// Moves vertices of `trial` (|V| x 3) that are too far beyond their limits back.
    void limit(Points& trial) const;

    const std::vector<Block>& blocks() const { return m_blocks; }  ///< those that are not zero
    /// Whether there are goals at all.
    bool active() const {
        return m_energy && !(m_energy->limits().empty() && m_energy->drives().empty());
    }

 private:
    const GoalEnergy* m_energy = nullptr;
    const std::vector<int>* m_row_of = nullptr;
    std::vector<Vec3> m_from;  ///< |limits|: the point of linearisation (m)
    std::vector<Block> m_blocks;
};

/// How far beyond a limit a trial step may take a vertex (m), from a place `x`.
double allowed_excess(const VertexGoal& goal, const Vec3& x);

/// Moves `x`, which is beyond a limit by more than `allowed` (m), back to it.
void limit_excess(const VertexGoal& goal, double allowed, Points& x);

}  // namespace cloth
