#pragma once

#include <string>
#include <vector>

#include "demos/bake/character_scene.h"

namespace cloth {

struct BakeOptions {
    CharacterSceneSettings character;  ///< if `character.character` names a file
    std::string garment = "tshirt";    ///< of the wardrobe, or the mesh file for a character
    std::string motion;                ///< of the project's body, or the character's animation
    std::string fabric = "soft";
    std::string solver = "quasi-newton";
    int rate = 30;     ///< frames and steps per second
    int frames = 0;    ///< in the cache, the first pose included; 0: as many as the motion has
    int threads = 0;   ///< 0: all cores
    std::string out;   ///< the garment's cache
    std::string body;  ///< the body's; empty: none
    bool resume = false;
};

/// @throws UsageError naming the option; HelpText if it is asked for; ArgumentError for an unknown
///         ending of a cache
BakeOptions parse_bake_options(const std::vector<std::string>& arguments);

}  // namespace cloth
