#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// Wall time of one step by stage (ms).
struct StageTimes {
    double proximity = 0.0;  ///< nearest points on the obstacles, and limbs that overlap
    double features = 0.0;   ///< building the network's input
    double solve = 0.0;      ///< network evaluation and solver iterations
    double contact = 0.0;    ///< contact projection, and the search for tunnelling
    double total() const { return proximity + features + solve + contact; }
    StageTimes& operator+=(const StageTimes& other) {
        proximity += other.proximity;
        features += other.features;
        solve += other.solve;
        contact += other.contact;
        return *this;
    }
};

/// What happened inside one step; the per-frame path reports, it does not throw.
struct StepReport {
    bool finite = true;  ///< false: the state was left as it was before the step
    int iterations = 0;  ///< solver iterations spent
    int substeps = 1;    ///< equal parts in which the step was taken
    /// |gradient| of the incremental potential after the step, over the norm of gravity's and
    /// inertia's forces at x_t; none: not computed.
    std::optional<double> residual;
    /// What the last five quasi-Newton iterations, or the last one by Newton's method, gained, as a
    /// distance (m), see MinimiseReport; none: there were fewer.
    std::optional<double> gain;
    bool converged = false;            ///< the stepper's own tolerance was met
    bool out_of_time = false;          ///< Stepper::set_max_ms() ended iterations, cuts or searches
    bool prediction_rejected = false;  ///< the network's answer was not finite, or of higher energy
                                       ///< than the guess, which the step started from instead
    double max_penetration = 0.0;  ///< depth inside an obstacle after the step (m): deepest vertex
                                   ///< that is not pinned, edge midpoint or face centre
    double max_entry = 0.0;        ///< deepest vertex before contact projection moved it out (m): a
                                   ///< contact that the step did not foresee
    /// How thick the thinnest obstacle is that the garment went through on the way (m), see
    /// TunnellingDetector; none: nothing was found, or it was not searched for.
    std::optional<double> tunnelled;
    int points_tunnelled = 0;  ///< vertices, edge midpoints and face centres that went through one
    int vertices_in_ignored_limbs = 0;  ///< vertices inside a limb that they ignore, see
                                        ///< LimbOverlap; max_penetration does not count them
    double max_ignored_depth = 0.0;     ///< how deep the deepest of them is inside (m)
    /// Skinned goals: vertices that end beyond their limits because an obstacle is in the way, and
    /// how far the farthest of them is beyond (m).
    int vertices_beyond_goals = 0;
    double max_goal_excess = 0.0;
    /// Edges of the garment that pass through its faces after the step; counted with self-contact
    /// on only, and not where limbs that the cloth ignores overlap its own.
    int tangles = 0;
    Vec3 first_tangle = Vec3::Zero();  ///< where the first of them is (m)
    StageTimes times;

    /// The report of a step that could not be made.
    static StepReport failed() {
        StepReport report;
        report.finite = false;
        return report;
    }
};

/// Advances one garment by one time step. Every solver, physical or learned, is a Stepper.
///
///     ClothStepper stepper(garment);
///     StepReport report = stepper.step(boundary, 1.0 / 30.0, state);
///
/// Contract (tests/gnn/stepper_contract_test.cpp): pins land on their targets, equal inputs give
/// equal bits for any thread count, and a failed step leaves `state` untouched.
class Stepper {
 public:
    virtual ~Stepper() = default;

    virtual std::string name() const = 0;

    /// Time step this stepper is made for (s); 0 if it accepts any.
    virtual double fixed_dt() const { return 0.0; }

    /// Whether it takes steps of other lengths too, without what is made for fixed_dt(). If not,
    /// Bullet's bodies that are anchored to the cloth are foreseen over fixed_dt(), and light ones
    /// on stiff cloth may be thrown.
    virtual bool accepts_any_dt() const { return fixed_dt() == 0.0; }

    /// Builds ahead of time what steps of this length (s) need, and parts of them, such as
    /// factorisations. Without it the first such step, or step in so many parts, builds them.
    virtual void prepare(double dt) { (void)dt; }

    /// @param boundary  obstacle surfaces at t and t+dt, pin targets at t+dt, gravity (m/s^2)
    /// @param dt        time step (s)
    /// @param state     positions (|V| x 3, m) and velocities (|V| x 3, m/s), advanced in place
    virtual StepReport step(const Boundary& boundary, double dt, ClothState& state) = 0;

    /// A state that step() returned was moved as a rigid body, positions and velocities: the next
    /// step goes on with what the stepper remembers of it, turned alike.
    /// @param before, after  |V| x 3 (m): its positions
    /// @param turn           the motion's rotation
    virtual void moved(const Points& before, const Points& after, const Eigen::Matrix3d& turn) {
        (void)before, (void)after, (void)turn;
    }

    /// Whether step() may run while steps of other independent steppers do, in other threads:
    /// nothing that it changes is theirs too.
    virtual bool is_independent() const { return false; }

    /// Limits the time of each step from now on (ms, above 0; infinity: no limit). It ends
    /// iterations, cuts and searches early: what a step does then depends on how fast the machine
    /// is. `residual`, `gain` and `tunnelled` of its report say what was reached.
    /// @return  false: this stepper takes the time that it takes
    virtual bool set_max_ms(double ms) {
        (void)ms;
        return false;
    }

    /// Limits the solver iterations of each step, or part of a step, from now on (1 or more), where
    /// its settings ask for more: how cloth that is far away costs less.
    /// @return  false: this stepper takes those that it takes
    virtual bool set_max_iterations(int most) {
        (void)most;
        return false;
    }

    /// Steps go on from now on, beyond what the settings ask for, until StepReport::residual is at
    /// most this (above 0; infinity: as the settings say), or for 200 iterations: what pulls the
    /// cloth is known as well as that.
    /// @return  false: this stepper goes on for as long as it does
    virtual bool set_most_residual(double most) {
        (void)most;
        return false;
    }

    /// Where the next step's iterations start (|V| x 3, m), if it is taken whole, and if that is of
    /// less energy than where they would: the end of a step from the same state that differs
    /// little.
    /// @return  false: this stepper starts where it does
    virtual bool start_next_at(const Points& x) {
        (void)x;
        return false;
    }

    /// Whether contact projection keeps edges and faces out of obstacles from now on, as it does at
    /// first, or vertices alone, which costs less: for a garment that is not shown. max_penetration
    /// is then that of vertices.
    /// @return  false: this stepper keeps to what it does
    virtual bool set_surface_projection(bool on) {
        (void)on;
        return false;
    }

    /// Forces of the fabric alone, stretch and bending, at x (|V| x 3, m), on pins too (|V| x 3,
    /// N); they sum to zero. What they leave of a step's change of momentum came from outside.
    /// @return  false, `forces` untouched: this stepper does not know
    virtual bool internal_forces(const Points& x, Points& forces) const {
        (void)x, (void)forces;
        return false;
    }

    /// Energy of these forces at x (J); none: this stepper does not know.
    virtual std::optional<double> internal_energy(const Points& x) const {
        (void)x;
        return std::nullopt;
    }

    /// Limbs that each vertex ignored in the last step (|V|), see LimbOverlap; empty: none did.
    virtual const std::vector<LimbSet>& ignored_limbs() const {
        static const std::vector<LimbSet> none;
        return none;
    }
};

}  // namespace cloth
