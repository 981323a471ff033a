#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

#include "tests/bench/network_scene.h"

namespace cloth::test {

/// Registers the network in LibTorch; without LibTorch nothing is registered.
void register_torch(const std::string& name, const ModelConfig& config,
                    std::function<const TshirtMoment*()> moment,
                    std::function<void(benchmark::State&, double flops)> report);

}  // namespace cloth::test
