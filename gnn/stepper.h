#pragma once

#include <limits>
#include <string>

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// Wall time of one step by stage (ms).
struct StageTimes {
    double proximity = 0.0;  ///< nearest points on the obstacles
    double features = 0.0;   ///< building the network's input
    double solve = 0.0;      ///< network evaluation or solver iterations
    double contact = 0.0;    ///< projection and resolution of contacts
    double total() const { return proximity + features + solve + contact; }
};

/// What happened inside one step; the per-frame path reports, it does not throw.
struct StepReport {
    int iterations = 0;  ///< solver or refinement iterations spent
    double residual =
        0.0;  ///< |gradient| of the incremental potential after the step, over
              ///< the norm of gravity's and inertia's forces at x_t; NaN: not computed
    /// What the last five quasi-Newton iterations gained, as a distance (m), see MinimiseReport;
    /// +inf: there were fewer.
    double gain = std::numeric_limits<double>::infinity();
    bool converged = false;        ///< the stepper's own tolerance was met
    double max_penetration = 0.0;  ///< depth inside an obstacle after the step (m): deepest vertex
                                   ///< that is not pinned, edge midpoint or face centre
    double max_entry = 0.0;  ///< deepest vertex before contact projection pushed it out (m): a
                             ///< contact that the step did not foresee
    /// How thick the thinnest obstacle is that the garment went through on the way (m), see
    /// TunnellingDetector; +inf: none was found. Looked for by WatchedStepper.
    double tunnelled = std::numeric_limits<double>::infinity();
    int vertices_in_ignored_limbs = 0;  ///< vertices inside a limb that they ignore, see
                                        ///< LimbOverlap; max_penetration does not count them
    double max_ignored_depth = 0.0;     ///< how deep the deepest of them is inside (m)
    bool finite = true;                 ///< false: the state was left as it was before the step
    int tangles = 0;  ///< edges of the garment that pass through its faces after the step; counted
                      ///< with self-contact on only
    Vec3 first_tangle = Vec3::Zero();  ///< where the first of them is (m)
    StageTimes times;
};

/// Advances one garment by one time step. Every solver, physical or learned, is a Stepper.
///
///     QuasiNewtonStepper stepper(garment, {});
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

    /// @param boundary  obstacle surfaces at t and t+dt, pin targets at t+dt, gravity (m/s^2)
    /// @param dt        time step (s)
    /// @param state     positions (|V| x 3, m) and velocities (|V| x 3, m/s), advanced in place
    virtual StepReport step(const Boundary& boundary, double dt, ClothState& state) = 0;

    /// Forces of the fabric alone, stretch and bending, at x (|V| x 3, m), on pins too (|V| x 3,
    /// N); they sum to zero. What they leave of a step's change of momentum came from outside.
    /// @return  false, `forces` untouched: this stepper does not know
    virtual bool internal_forces(const Points& x, Points& forces) const {
        (void)x, (void)forces;
        return false;
    }
};

}  // namespace cloth
