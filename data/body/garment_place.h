#pragma once

#include <string>
#include <vector>

#include "data/core/length_units.h"
#include "data/core/types.h"

namespace cloth {

/// Whether a garment is where the body is and of its size: within the body's box, widened by what
/// skirts and capes need, and not smaller than a twentieth of its height.
bool is_in_place(const Points& garment, const Points& skin);

/// Points with z up turned so that y is up: (x, y, z) becomes (x, z, -y).
Points with_y_up(const Points& z_up);

/// The units in which a garment that is elsewhere would be of the body's size: a tenth of its
/// height to all of it, and a little.
std::vector<LengthUnit> plausible_sizes(const Points& file_vertices, const Points& skin);

/// How the numbers of a garment's file may have been meant.
struct PlaceGuess {
    LengthUnit unit;
    bool z_up = false;
};

/// The units and up axes with which the garment is in place, as wide as a waist, and nine tenths of
/// its height beside the body. Only those with y up, if there are any.
/// @param file_vertices  |V| x 3, as the file has them
/// @param skin           (m)
std::vector<PlaceGuess> guess_place(const Points& file_vertices, const Points& skin);

}  // namespace cloth
