#pragma once

#include <string>

#include "demos/compare/comparison_scene.h"

namespace cloth {

/// What the engine holds for a network and a garment: weights, tables and workspace (MB of 1e6
/// bytes). Counted by the engine, to the byte; a process has more.
/// @param file  of the weights
/// @throws LoadError if they cannot be used
double network_memory_mb(const std::string& file, const ComparisonScene& scene,
                         const ClothState& start);

}  // namespace cloth
