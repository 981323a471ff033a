#pragma once

#include <string>

#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/stepper.h"

namespace cloth {

/// Says where the minimisation of a step, or of a small step of its length, starts: a network, or a
/// test's stand-in for one. Without one a step starts at the guess, the projected extrapolation.
class StepStart {
 public:
    virtual ~StepStart() = default;

    virtual std::string name() const = 0;
    /// Time step that it is made for (s).
    virtual double fixed_dt() const = 0;

    /// Whether predict() may run while other independent ones do, in other threads.
    virtual bool is_independent() const { return false; }

    /// @param potential   begun for this step, with the nearest points of state.x
    /// @param guess       |V| x 3 (m), pins at their targets
    /// @param at_guess    E and its gradient at the guess, where it computes them; else as it was
    /// @param prediction  |V| x 3 (m); pins need not be in place. Not finite: it failed
    /// @param times       `features` and `solve` grow
    /// @return            whether at_guess was filled
    virtual bool predict(const ClothState& state, const Boundary& boundary,
                         const IncrementalPotential& potential, const Points& guess,
                         PotentialValue& at_guess, Points& prediction, StageTimes& times) = 0;
};

}  // namespace cloth
