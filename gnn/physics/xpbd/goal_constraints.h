#pragma once

#include <vector>

#include "data/core/boundary.h"
#include "data/core/garment.h"
#include "gnn/physics/xpbd/distance_constraints.h"

namespace cloth {

/// Skinned goals (see GoalLimits) in the substeps of XPBD: drives as implicit springs, limits as
/// hard constraints. Goals move evenly from where they are at t to where they are at t + dt.
/// Nothing where the garment has none.
class GoalConstraints {
 public:
    /// Keeps a reference to `garment`.
    explicit GoalConstraints(const Garment& garment) : m_garment(&garment) {}

    void begin_step(const SkinGoals& goals, double dt, int substeps);
    /// @param substep  1 to substeps
    void begin_substep(int substep);
    /// Pulls driven vertices, which have moved freely.
    /// @param before  positions at the start of the substep
    void drive(const PaddedPoints& before, PaddedPoints& x) const;
    /// Moves what is beyond a limit back.
    void project(PaddedPoints& x) const;

 private:
    struct Limit {
        VertexGoal goal;  ///< at the end of the substep
        Vec3 place, move, normal, turn;
    };
    struct Drive {
        int vertex;
        Vec3 place, move;
        double pull, drag;  ///< s h^2 and c h, without dimension
    };

    const Garment* m_garment;
    double m_length = 1.0;    ///< of a substep, of the step
    double m_progress = 0.0;  ///< at the end of the substep
    std::vector<Limit> m_limits;
    std::vector<Drive> m_drives;
};

}  // namespace cloth
