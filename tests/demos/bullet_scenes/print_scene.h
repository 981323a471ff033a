#pragma once

#include <ostream>

#include "demos/bullet_scenes/worlds/scenes.h"

/// A test of a scene is listed by the scene's name.
inline void PrintTo(const SceneRecipe& recipe, std::ostream* out) {
    *out << recipe.name;
}
