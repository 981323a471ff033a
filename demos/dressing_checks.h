#pragma once

#include <string>
#include <vector>

#include "data/body/welded_character.h"
#include "data/core/garment.h"

namespace cloth {

// What the programs that take a character and a garment of yours find out before they run.

/// @throws ArgumentError if the character is lower than 0.1 m or higher than 10 m
void check_height(const std::string& file, const WeldedCharacter& skin);

/// @throws ArgumentError naming the file if its skin is no surface that cloth can be kept off: an
///         edge of more than two faces, a face without area
void check_surface(const std::string& file, const WeldedCharacter& skin);

/// The vertices of `x` (|V| x 3, m) between two heights, the option --pin.
/// @param heights  lowest and highest y (m), or empty: no vertex
/// @throws ArgumentError if no vertex is there
std::vector<int> vertices_between(const Points& x, const std::vector<double>& heights);

/// From the garment as it was modelled to the skin (m).
/// @throws ArgumentError if it is more than 0.3 m
double distance_to_skin(const Garment& garment, const WeldedCharacter& skin);

}  // namespace cloth
