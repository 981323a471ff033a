#pragma once

#include <vector>

#include "collision/response/goal_projection.h"
#include "collision/self/self_contact_settings.h"
#include "collision/self/tangle_measure.h"
#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "gnn/physics/energy/elastic.h"

namespace cloth {

/// What Untangling did after one step.
struct UntanglingReport {
    int moves = 0;        ///< that were taken
    double before = 0.0;  ///< TangleMeasure (m)
    double after = 0.0;
};

/// Draws cloth that has passed through itself, or through another layer, apart again, a little
/// after each step. It descends along smoothed, mass-weighted gradients of TangleMeasure P and
/// takes a move only if
///
///     fabric's energy + potential of gravity + untangling_tension P
///
/// falls by it, where a part that the move itself cuts off does not count yet. So the fabric and
/// gravity gain at most the tension times what P has lost.
///
/// Velocities do not follow the moves. What of them would undo the moves is taken out, by one
/// factor for the whole garment: kinetic energy never rises here, and where no pin, goal or
/// obstacle is in the way, linear momentum and the centre of mass are kept.
///
/// The result depends on the state alone: there is no memory from step to step. Effort is bounded
/// by the settings, whether or not the tangles can be undone. Never throws.
class Untangling {
 public:
    /// Keeps a reference to `garment`. @throws ArgumentError if a setting is out of range
    Untangling(const Garment& garment, const SelfContactSettings& settings);

    /// What holds the cloth at t + dt.
    struct Surroundings {
        const Boundary& boundary;
        Proximity& proximity;
        GoalProjection& goals;      ///< begun for this step
        double distance;            ///< of vertices from obstacles (m)
        SurfaceContacts& contacts;  ///< nearest points at t + dt, or empty; brought up to date
    };

    /// @param dt     of the step (s)
    /// @param state  at the end of a step, with tangles
    UntanglingReport run(const Surroundings& outside, double dt, ClothState& state);

    const std::vector<Tangle>& tangles() const { return m_measure.tangles(); }  ///< that are left

 private:
    void measure(const Boundary& boundary);
    bool move(const Surroundings& outside);
    bool find_direction(const Surroundings& outside);
    void smooth_forces();
    void smooth_motions();
    void keep_out(const Surroundings& outside);
    void hold(const Surroundings& outside);
    double energy(const Boundary& boundary, const Points& x) const;
    void slow_down(double dt, const Points& x0, ClothState& state) const;

    const Garment* m_garment;
    SelfContactSettings m_settings;
    ElasticEnergy m_elastic;
    TangleMeasure m_measure;
    VectorX m_mobility;              ///< |V| (1/kg), 0 of what is pinned or held at its goal
    std::vector<double> m_exchange;  ///< |E| (kg): of smoothing
    std::vector<char> m_wrong;       ///< |V|: on the wrong side at m_x
    std::vector<int> m_rows;
    double m_energy = 0.0;  ///< with that of the tangles, at m_x (J)
    double m_size = 0.0;    ///< P at m_x (m)
    Points m_x, m_trial, m_gradient, m_direction;
};

}  // namespace cloth
