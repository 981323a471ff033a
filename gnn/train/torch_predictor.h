#pragma once

#include <memory>
#include <string>

#include "gnn/model/predictor.h"
#include "gnn/model/weights.h"

namespace cloth {

/// Evaluates trained weights with LibTorch's own operations: the engine's oracle and yardstick.
/// @param device  "cpu" or "cuda"
/// @throws ArgumentError if the device is not available
std::unique_ptr<Predictor> make_torch_predictor(const Weights& weights,
                                                const std::string& device = "cpu");

}  // namespace cloth
