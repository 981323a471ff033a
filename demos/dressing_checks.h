#pragma once

#include <string>
#include <vector>

#include "data/body/welded_character.h"
#include "data/core/garment.h"

namespace cloth {

// What the programs that take a character and a garment of yours find out before they run, and how
// they judge its end.

/// @throws ArgumentError if the character is lower than 0.1 m or higher than 10 m
void check_height(const std::string& file, const WeldedCharacter& skin);

/// @throws ArgumentError naming the file if its skin is no surface that cloth can be kept off: an
///         edge of more than two faces, a face without area, faces that look inwards
void check_surface(const std::string& file, const WeldedCharacter& skin);

/// What is to be told of the character's file, a sentence each.
std::vector<std::string> character_notes(const std::string& file, const WeldedCharacter& skin);

/// Compares files, whatever the paths that name them.
/// @param option   that names the outputs, and its value
/// @param outputs  that will be written; they need not be there
/// @throws ArgumentError naming the first of `inputs` that is one of them
void check_not_overwritten(const std::string& option, const std::vector<std::string>& outputs,
                           const std::vector<std::string>& inputs, const std::string& remedy);

/// The vertices of `x` (|V| x 3, m) between two heights, the option --pin.
/// @param heights  lowest and highest y (m), or empty: no vertex
/// @throws ArgumentError if no vertex is there
std::vector<int> vertices_between(const Points& x, const std::vector<double>& heights);

/// From the garment as it was modelled to the skin (m).
/// @throws ArgumentError if it is more than 0.3 m
double distance_to_skin(const Garment& garment, const WeldedCharacter& skin);

/// How a garment is at the end of a run.
struct WornState {
    double stretch99 = 1.0, stretch = 1.0;  ///< of 99 % of its edges, of all: lengths over those at
                                            ///< rest
    double away = 0.0;                      ///< from the skin (m), negative inside
};

/// @param x     |V| x 3 (m): the garment
/// @param skin  at the same time
WornState worn_state(const Garment& garment, const Points& x, const TriMesh& skin);

/// Why a garment is not worn any more; empty: it is.
/// @param failed_steps  of the run
std::string worn_problem(const WornState& state, long failed_steps = 0);

}  // namespace cloth
