#pragma once

#include "demos/compare/solver_factory.h"

namespace cloth {

/// Runs networks with LibTorch on the CPU; empty if this program is built without it.
TorchMaker torch_backend(int threads);

}  // namespace cloth
