#pragma once

#include <vector>

#include "data/authoring/garment_recipe.h"

namespace cloth {

/// The rest shape of a garment that sits on the waist: as worn, but the band below the upper edge
/// is as much shorter as the recipe says, and the cloth below is gathered to it.
/// @param worn  |V| x 3 (m)
/// @param top   height of the upper edge (m)
Points without_stretch(const Points& worn, double top, const GarmentRecipe& recipe);

/// The same for a garment of any cut, whose upper edge need not be level: the band is `width` (m)
/// below the nearest point of that edge, and `ratio` times as long as it is worn.
/// @param upper_edge  a loop of vertices
Points without_stretch(const Points& worn, const std::vector<int>& upper_edge, double width,
                       double ratio);

}  // namespace cloth
