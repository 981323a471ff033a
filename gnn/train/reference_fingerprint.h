#pragma once

#include <cstdint>

#include "gnn/train/training_scene.h"

namespace cloth {

/// Tells a scene from others whose reference is another: garment, fabric, pins and time step, the
/// state that it starts from, and all that is outside of it in the steps from there on.
/// @param frames  steps that are looked at
std::uint64_t reference_fingerprint(const TrainingScene& scene, int frames);

}  // namespace cloth
