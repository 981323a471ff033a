#pragma once

#include "data/scalar_grid.h"
#include "data/tshirt.h"

namespace cloth {

/// The closed surface that a T-shirt is cut from: around torso, upper arms and neck.
TriMesh tshirt_surface(const TriMesh& body, const TshirtRecipe& recipe);

}  // namespace cloth
