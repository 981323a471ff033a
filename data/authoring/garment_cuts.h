#pragma once

#include "data/authoring/garment_recipe.h"
#include "data/core/mesh.h"

namespace cloth {

/// Opens the closed surface around the body at neck or waist, arms and hem; what is left of arms
/// and head falls away.
TriMesh cut_garment(const TriMesh& surface, const BodyLandmarks& marks,
                    const GarmentRecipe& recipe);

}  // namespace cloth
