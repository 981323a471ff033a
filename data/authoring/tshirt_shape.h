#pragma once

#include "data/authoring/scalar_grid.h"
#include "data/authoring/tshirt.h"

namespace cloth {

/// The closed surface that a T-shirt is cut from: around torso, upper arms and neck.
TriMesh tshirt_surface(const TriMesh& body, const TshirtRecipe& recipe);

/// @throws ArgumentError naming the field that is out of range
void check_tshirt_recipe(const TshirtRecipe& recipe);

}  // namespace cloth
