#pragma once

#include "data/authoring/garment_recipe.h"

namespace cloth {

/// The rest shape of a garment that sits on the waist: as worn, but the band below the upper edge
/// is as much shorter as the recipe says, and the cloth below is gathered to it.
/// @param worn  |V| x 3 (m)
/// @param top   height of the upper edge (m)
Points without_stretch(const Points& worn, double top, const GarmentRecipe& recipe);

}  // namespace cloth
