#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gnn/stepper.h"

namespace cloth::test {

struct StepperKind {
    std::string name;
    std::function<std::unique_ptr<Stepper>(const Garment&)> make;
};

/// One of each: few iterations, a network of two steps with weights at random.
const std::vector<StepperKind>& stepper_kinds();

/// The same bits, NaN included.
bool same_bits(const ClothState& a, const ClothState& b);

/// What the promise of Stepper::step() leaves to be said about one step from `before` to `after`;
/// "" if it is kept.
std::string broken_promise(const Garment& garment, const Boundary& boundary,
                           const StepReport& report, const ClothState& before,
                           const ClothState& after);

/// Steps and checks; returns what is wrong, an exception included.
std::string checked_step(Stepper& stepper, const Garment& garment, const Boundary& boundary,
                         double dt, ClothState& state);

}  // namespace cloth::test
