#pragma once

#include "collision/response/contact_projection.h"
#include "collision/response/goal_projection.h"
#include "gnn/physics/stepper/self_contact_projection.h"
#include "gnn/physics/xpbd/distance_constraints.h"
#include "gnn/physics/xpbd/goal_constraints.h"
#include "gnn/physics/xpbd/moving_planes.h"
#include "gnn/physics/xpbd/self_contact_planes.h"
#include "gnn/stepper.h"

namespace cloth {

struct XpbdSettings {
    int substeps = 20;   ///< per step, 1 to 1000; cost and stiffness grow with it: with few, stiff
                         ///< cloth stretches like rubber
    int iterations = 1;  ///< over all constraints per substep, 1 to 100; more substeps are the
                         ///< better use of time (Macklin et al. 2019)
    /// Of constraints, 1 to 1.3. 1.2 brings 20 and 40 substeps nearer to the reference than 1; from
    /// 1.4 on stiff cloth explodes.
    double relaxation = 1.2;
    double damping = 0.0;  ///< of velocities (1/s), 0 to 10; 0: only what substeps damp themselves
    double bending_angle = 1.0;  ///< fold (rad) at which springs bend like the fabric, 0.01 to 1.5
    double contact_distance = 4e-3;  ///< vertices are held off obstacles by this (m), 5e-4 to 1e-2
    SelfContactSettings self_contact;  ///< off by default; its weight has no meaning here
};

/// What games use: springs on edges and across hinges, relaxed once in each of many substeps of a
/// frame. XPBD (Macklin et al. 2016, "XPBD: position-based simulation of compliant constrained
/// dynamics") with small steps (Macklin et al. 2019, "Small steps in physics simulation"). The
/// stiffness is the fabric's (see spring_net.h), but is reached with enough substeps only.
///
///     XpbdSettings settings;
///     settings.substeps = 40;
///     XpbdStepper stepper(garment, settings);
///     StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
///
/// Obstacles are queried once per step and move along as planes; pins and goals move linearly;
/// projections leave nothing inside an obstacle and nothing beyond the limits of goals. Accepts any
/// time step.
///
/// ClothState has the mean velocity over a step, which lags behind the velocity at its end, from
/// which substeps go on. A state whose positions are those this stepper returned last goes on with
/// its velocities (which others may have changed) plus the lag that was left then. For any other
/// state the lag is estimated by a trial of the same step, which doubles its cost: half of what the
/// trial accelerates, of each vertex at most half of a free fall. So free falls are backward
/// Euler's for any number of substeps and from any state in which the fabric is at ease. Where it
/// is not, as in wrinkled cloth, the vertices' own accelerations take a part of that limit: such a
/// step may gain as little as half of a free fall's velocity.
class XpbdStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if a setting is out of range
    explicit XpbdStepper(const Garment& garment, const XpbdSettings& settings = {},
                         const ProximitySettings& proximity = {});

    /// "xpbd-N" with N substeps.
    std::string name() const override;
    bool is_independent() const override { return true; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool set_surface_projection(bool on) override {
        m_resolver.set_surface(on);
        return true;
    }

 private:
    void find_contacts(const Boundary& boundary, const ClothState& state);
    void start(const Boundary& boundary, double dt, const ClothState& state);
    void estimate_lag(const Boundary& boundary, double dt, const ClothState& state);
    void run(const Boundary& boundary, double dt, const Points& x0);
    void move_freely(const Boundary& boundary, double h);
    void move_pins(const Boundary& boundary, const Points& x0, double progress);
    void resolve(const Boundary& boundary, double dt, StepReport& report);
    void finish_self_contact(const Boundary& boundary, double dt, const ClothState& state,
                             StepReport& report);
    void finish_goals(double dt, const ClothState& state, StepReport& report);
    bool finish(double dt, ClothState& state);

    const Garment* m_garment;
    XpbdSettings m_settings;
    DistanceConstraints m_stretch, m_bending;
    double m_prepared_dt = 0.0;  ///< time step of the constraints (s)
    Proximity m_proximity;
    ContactProjection m_resolver;
    GoalProjection m_goal_resolver;
    SurfaceContacts m_contacts;
    MovingPlanes m_planes;
    GoalConstraints m_goals;
    SelfContactPlanes m_self_planes;
    SelfContactProjection m_self_contact;
    PaddedPoints m_p, m_w, m_before;  ///< of the substep: positions, velocities, start
    Points m_x, m_v;                  ///< |V| x 3: at the end of the step; the mean velocity (m/s)
    Points m_last_x, m_lag;  ///< |V| x 3: what was returned last, velocity at its end - mean
};

}  // namespace cloth
