#pragma once

#include <optional>
#include <string>

#include "demos/bake/character_scene.h"

namespace CLI {
class App;
}

namespace cloth {

/// Who wears what, in which motion, and how it is stepped: what `bake` and `viewer` share.
struct SceneOptions {
    CharacterSceneSettings character;    ///< if `character.character` names a file
    std::string garment = "tshirt";      ///< of the wardrobe, or the mesh file for a character
    std::string shape = "default";       ///< of the project's body, see body_named()
    std::string motion;                  ///< of the project's body, or the character's animation
    std::optional<double> goal_colours;  ///< of a character's garment: what red just below 1 is
                                         ///< (m); none: its colours are not read
    std::string fabric = "soft";
    std::string solver = "default";
    int rate = 30;   ///< frames and steps per second
    int frames = 0;  ///< the first pose included; 0: as many as the motion has
};

/// The options --garment, --motion, --fabric, --solver, --rate, and those of a --character, which
/// are refused without one.
/// @param options  must live until the command line is parsed
void add_scene(CLI::App& app, SceneOptions& options);

/// To be called after the command line was read: checks names, and hands on to a character what is
/// meant for it. @throws UsageError
void finish_scene(SceneOptions& options);

}  // namespace cloth
