#pragma once

#include <Eigen/SparseCore>
#include <memory>

#include "collision/proximity/proximity.h"
#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "gnn/physics/energy/block_pattern.h"
#include "gnn/physics/energy/contact.h"
#include "gnn/physics/energy/elastic.h"
#include "gnn/physics/energy/friction.h"
#include "gnn/physics/energy/goal_energy.h"
#include "gnn/physics/energy/gravity.h"
#include "gnn/physics/energy/inertia.h"
#include "gnn/physics/energy/layer_friction.h"
#include "gnn/physics/energy/ridge_energy.h"
#include "gnn/physics/energy/self_contact.h"

namespace cloth {

/// Constants of the incremental potential that are not the fabric's.
struct PotentialSettings {
    Integrator integrator = Integrator::backward_euler;  ///< of steppers
    double contact_distance = 4e-3;  ///< cloth is pushed away below this distance (m), 1e-3 to 1e-2
    double contact_weight = 5e5;     ///< w in w max(0, eps - d)^3 (N/m^2), 1e3 to 1e6
    /// Faces and edges that bend over ridges of obstacles are pushed away below this distance (m),
    /// 0 to contact_distance; 0: only vertices feel obstacles.
    double ridge_distance = 1e-3;
    double friction_scale = 1.0;      ///< on the obstacles' coefficients, 0 to 10; 0: no friction
    double friction_distance = 6e-3;  ///< friction acts on vertices closer than this (m), 0 to 0.1
    /// Sliding slower than about three times this (m/s, 1e-5 to 1) feels less than its friction.
    /// Cloth that is pulled by less than 0.95 of its friction does not creep on obstacles; at 0.98
    /// it creeps about twice as fast as this, and faster still nearer to the limit.
    double friction_slip_speed = 3e-3;
    /// Largest normal force (in units of the vertex's weight, on Earth at least) that the pressure
    /// of a contact can claim for friction, 0 to 100; 0: only the weight that the surface carries.
    double friction_limit = 10.0;
    /// Of two skins on the cloth between them (Pa, 0 to 1e5), see Boundary::pinched. Without it
    /// sleeves slip off arms that are folded into the chest; too much of it tears at them. The
    /// default is a light touch: 1 kg on 250 cm^2.
    double pinch_pressure = 400.0;
    /// Of the limits of skinned goals, in units of the fabric's longitudinal stiffness, 0.1 to
    /// 1000. What it leaves beyond a limit is projected back at the end of a step.
    double goal_stiffness = 10.0;
    SelfContactSettings self_contact;  ///< off by default
};

/// The parts of the incremental potential (J).
struct EnergyTerms {
    double strain = 0, bending = 0, gravity = 0, inertia = 0;
    double contact = 0;   ///< of vertices and of ridges
    double friction = 0;  ///< on obstacles, and between layers
    double self_contact = 0;
    double goals = 0;  ///< limits and drives of skinned goals
    double total() const {
        return strain + bending + gravity + inertia + contact + friction + self_contact + goals;
    }
};

/// E and its gradient at one x.
struct PotentialValue {
    double energy = 0.0;  ///< (J)
    Points gradient;      ///< |V| x 3 (N), zero at pinned vertices
};

/// E(x) of one implicit step; its minimum is the garment's position at t + dt.
///
///     IncrementalPotential potential(garment, settings);
///     potential.begin_step(state, boundary, contacts, dt);
///     double energy = potential.value_gradient(x, gradient);
///
/// Pinned vertices are variables like all others here; solvers hold them at their targets and the
/// gradient and Hessian rows of pinned vertices are zero (Hessian diagonal one).
///
/// Evaluations are const, allocate nothing once their outputs have the right size, never throw and
/// run on the calling thread, so several threads may evaluate one potential.
class IncrementalPotential {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if a setting is out of range
    explicit IncrementalPotential(const Garment& garment, PotentialSettings settings = {});

    /// Fixes everything that does not depend on the unknown x. `contacts` are the nearest points of
    /// state.x at t, or empty where there is no obstacle. External accelerations and gravity come
    /// from `boundary`.
    /// @param inertia  of the time integration; null: backward Euler
    /// @param unrepelled  see SelfContactEnergy::begin_step()
    /// @throws ArgumentError if an array's size does not fit the garment, the garment has goals and
    ///         the boundary none for it, or dt is not positive
    void begin_step(const ClothState& state, const Boundary& boundary,
                    const SurfaceContacts& contacts, double dt,
                    const InertialStep* inertia = nullptr,
                    const std::vector<char>& unrepelled = {});

    EnergyTerms terms(const Points& x) const;
    double value(const Points& x) const;
    /// Of gravity and inertia alone: value() is never less, as the other terms are never negative.
    double value_of_motion(const Points& x) const;
    /// @param elastic  if not null, filled with elastic_gradient() at x
    double value_gradient(const Points& x, Points& gradient, Points* elastic = nullptr) const;
    /// Hessian of E (3|V| x 3|V|, both triangles), by default with each element's block made
    /// positive semi-definite. The sparsity is the same for every x of a step, and without
    /// self-contact for every step: a matrix passed again is only refilled.
    void hessian(const Points& x, Eigen::SparseMatrix<double>& hessian,
                 HessianKind kind = HessianKind::projected) const;
    /// Gradient of strain + bending only (|V| x 3, N): the force features' ingredient.
    void elastic_gradient(const Points& x, Points& gradient) const;

    /// Forces of strain and bending (|V| x 3, N), minus the gradient; on pinned vertices too.
    void internal_forces(const Points& x, Points& forces) const;

    /// Energy of strain and bending (J).
    double internal_energy(const Points& x) const;

    /// Norm of inertia's and gravity's forces at x_t over the free vertices (N): residual's scale.
    double force_scale() const { return m_force_scale; }

    const Garment& garment() const { return *m_garment; }
    const PotentialSettings& settings() const { return m_settings; }
    double dt() const { return m_dt; }
    double inertial_dt() const { return m_inertial_dt; }  ///< in the M / dt^2 of most vertices (s)
    const SurfaceContacts& contacts() const { return m_contacts; }
    const Points& inertial_target() const { return m_inertia.target(); }      ///< (m)
    const RidgeEnergy& ridges() const { return m_ridges; }                    ///< of this step
    const FrictionEnergy& friction() const { return m_friction; }             ///< of this step
    const SelfContactEnergy& self_contact() const { return m_self_contact; }  ///< of this step
    const LayerFriction& layer_friction() const { return m_layer_friction; }  ///< of this step
    const GoalEnergy& goals() const { return m_goals; }                       ///< of this step

    /// Moves a starting guess (|V| x 3, pins in place) that is too near to itself, or has passed
    /// through itself, apart again, and off the obstacles. Without self-contact it does
    /// nothing.
    void separate_self_contact(Points& guess) const;

    void set_contact_weight(double weight) { m_settings.contact_weight = weight; }

 private:
    void mask_pins(Points& gradient) const;
    void lift_off_obstacles(Points& x) const;
    double norm_of_forces_at(const ClothState& state) const;

    const Garment* m_garment;
    PotentialSettings m_settings;
    double m_dt = 0.0, m_inertial_dt = 0.0;
    double m_force_scale = 0.0;
    SurfaceContacts m_contacts;
    std::shared_ptr<const LazyBlockPattern> m_pattern;  ///< of the Hessian
    ElasticEnergy m_elastic;
    GravityEnergy m_gravity;
    InertiaEnergy m_inertia;
    ContactEnergy m_contact;
    RidgeEnergy m_ridges;
    FrictionEnergy m_friction;
    SelfContactEnergy m_self_contact;
    LayerFriction m_layer_friction;
    GoalEnergy m_goals;
};

}  // namespace cloth
