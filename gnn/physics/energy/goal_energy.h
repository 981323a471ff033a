#pragma once

#include <vector>

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// Skinned goals (see GoalLimits), each vertex by itself:
///
///     distance  k/2 max(0, |x - g| - R)^2                       R: max_distance
///     backstop  k/2 max(0, -B - (x - g) . n)^2                  B: backstop
///     drive     m s/2 |x - g|^2 + m c/(2 dt) |(x - x_t) - (g - g_t)|^2
///
/// g, n: goal and normal at t + dt; s, c: drive_stiffness and drive_damping. The limits' k is a
/// multiple of the fabric's stiffness (N/m), not of the mass: cloth that hangs on its limits stands
/// beyond them by a share of an edge that does not depend on how fine the mesh is. That is for the
/// projection after the minimum, see GoalProjection. Nothing where the garment has no goals.
class GoalEnergy {
 public:
    /// A vertex that is driven.
    struct Drive {
        int vertex;
        Vec3 place;        ///< g (m)
        Vec3 carried;      ///< x_t + g - g_t (m)
        double stiffness;  ///< m s (N/m)
        double damping;    ///< m c / dt (N/m)
        double total() const { return stiffness + damping; }
    };

    /// Keeps a reference to `garment`.
    explicit GoalEnergy(const Garment& garment) : m_garment(&garment) {}

    /// @param goals      that fit the garment, see are_goals_for()
    /// @param stiffness  k, in units of the fabric's longitudinal stiffness
    void begin_step(const ClothState& state, const SkinGoals& goals, double dt, double stiffness);

    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite by itself, to a matrix of `pattern`.
    void add_hessian(const Points& x, const BlockPattern& pattern, double* values) const;

    const std::vector<VertexGoal>& limits() const { return m_limits; }  ///< of free vertices
    const std::vector<Drive>& drives() const { return m_drives; }       ///< of free vertices
    double stiffness() const { return m_stiffness; }                    ///< k (N/m)

    /// Second derivative of a limit's energy at x (N/m).
    static Eigen::Matrix3d block(const VertexGoal& goal, double stiffness, const Vec3& x);

 private:
    void take_drives(const ClothState& state, const SkinGoals& goals, double dt);

    const Garment* m_garment;
    double m_stiffness = 0.0;
    std::vector<VertexGoal> m_limits;
    std::vector<Drive> m_drives;
};

}  // namespace cloth
