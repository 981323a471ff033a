#pragma once

#include "gnn/model/weights.h"

namespace cloth {

/// What keeps these weights from being those of their configuration: a tensor that is missing,
/// unknown, misshaped or not finite, or a deviation that is not positive. Empty place: nothing.
TensorProblem find_problem(const Weights& weights);

}  // namespace cloth
