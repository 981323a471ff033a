#pragma once

#include "data/authoring/garment_recipe.h"
#include "data/core/mesh.h"

namespace cloth {

/// The closed surface that a garment is cut from: around the trunk, and the arms and legs it has.
TriMesh garment_surface(const TriMesh& body, const BodyLandmarks& marks,
                        const GarmentRecipe& recipe);

/// Height of the hem, or of the ends of the legs (m).
double hem_height(const BodyLandmarks& marks, const GarmentRecipe& recipe);

/// Height of the upper edge of a garment that sits on the waist (m).
double waist_height(const BodyLandmarks& marks, const GarmentRecipe& recipe);

}  // namespace cloth
