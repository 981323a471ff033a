#pragma once

#include <vector>

#include "collision/proximity/proximity.h"
#include "data/core/boundary.h"
#include "data/core/garment.h"
#include "gnn/physics/xpbd/distance_constraints.h"

namespace cloth {

/// The obstacles as a step in substeps sees them: one plane per vertex, through the surface point
/// that was nearest at t, which moves with that point to t + dt.
///
/// The plane's normal is the direction from the surface point to the vertex at t (at corners and
/// edges of the obstacle that is not the face's normal), turned as the face turns.
///
/// A vertex that is closer than the contact distance at t is let out over the whole step, by
/// recover(), which moves it without giving it a velocity; project() then holds it at the distance
/// it has reached.
class MovingPlanes {
 public:
    /// @param distance  at which vertices are held from the surface (m)
    void begin_step(const Garment& garment, const Points& x, const Boundary& boundary,
                    const SurfaceContacts& contacts, double distance, int substeps);

    /// Starts substep 1 .. `substeps`: the planes move on.
    void begin_substep(int substep);

    /// Lets vertices out that were too close at t; to be done before the substep's motion.
    void recover(PaddedPoints& x) const;

    /// Pushes vertices that are too close out along the normal, and lets friction take off their
    /// tangential motion since `before`, relative to their places above the surface, which turn
    /// with it, by at most mu times the push (Coulomb's law for positions).
    void project(const PaddedPoints& before, PaddedPoints& x) const;

 private:
    struct Plane {
        Eigen::Index vertex;
        Vec3 point, point_move;    ///< at t, and from t to t + dt (m)
        Vec3 normal, normal_move;  ///< at t, and from t to t + dt
        bool turns;                ///< whether the normal moves, but for rounding
        double friction;           ///< Coulomb coefficient
        double deficit;            ///< too close by this at t (m), or 0
    };
    void add_plane(Eigen::Index vertex, const Points& x, const SurfaceContacts& contacts,
                   double friction);

    std::vector<Plane> m_planes;
    std::vector<size_t> m_too_close;  ///< planes with a deficit
    double m_distance = 0.0;
    double m_length = 1.0;    ///< of a substep, in steps
    double m_progress = 0.0;  ///< of the step, 0 to 1, at the end of the substep
};

}  // namespace cloth
