#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "tests/fuzz/fuzz_random.h"

namespace cloth::test {

/// Obstacles of all shapes near the garment, pin targets near the pins; often with defects: sizes
/// of 0, 1e-9, 1e6 and NaN, meshes with bad indices, flipped, crossing themselves or of another
/// size at the end of the step, motions of a kilometre, numbers that are not finite, arrays that do
/// not fit.
Boundary random_boundary(const Garment& garment, Random& random);

/// The garment at rest, moving or crumpled; now and then not finite, far away or of another size.
ClothState random_state(const Garment& garment, Random& random);

/// Usual time steps, and 0, negative, 1e-9, 10, NaN.
double random_time_step(Random& random);

}  // namespace cloth::test
