#pragma once

#include <memory>

#include "gnn/stepper.h"

namespace cloth {

/// Cuts each step into equal sub-steps of another stepper: smaller steps damp less and are nearer
/// to the equations of motion, and each moves obstacles less far. Obstacles, primitive frames and
/// pins move evenly from where they are at t to where the boundary says they are at t + dt.
///
///     SubsteppedStepper stepper(garment, std::make_unique<QuasiNewtonStepper>(garment, settings),
///     4);
///
/// ClothState has the mean velocity over a step; the velocity of the last sub-step, from which the
/// next step goes on, differs from it by a lag. A state whose positions are those that were
/// returned last goes on with its velocity (which others may have changed) and that lag, any other
/// state with its velocity alone. A sub-step that fails fails the step.
class SubsteppedStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`. @throws ArgumentError unless substeps is 1 to 64 and the
    /// stepper is there and takes any time step
    SubsteppedStepper(const Garment& garment, std::unique_ptr<Stepper> stepper, int substeps);

    /// The inner stepper's name, "x" and the number of sub-steps.
    std::string name() const override;
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool internal_forces(const Points& x, Points& forces) const override {
        return m_stepper->internal_forces(x, forces);
    }

 private:
    void place(const Boundary& boundary, int substep);

    const Garment* m_garment;
    std::unique_ptr<Stepper> m_stepper;
    int m_substeps;
    Boundary m_part;         ///< of one sub-step
    ClothState m_state;      ///< during the step
    Points m_pins_before;    ///< |pins| x 3 (m)
    Points m_last_x, m_lag;  ///< |V| x 3: what was returned last, its end velocity - its mean
};

}  // namespace cloth
