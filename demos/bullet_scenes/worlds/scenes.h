#pragma once

#include <vector>

#include "scene_world.h"

/// One scene: what the demos of Bullet's cloth show, each small enough to look at.
struct SceneRecipe {
    const char* name;
    const char* sentence;
    void (*build)(SceneWorld& scene);
    bool comes_to_rest;           ///< its last shape is the same for every solver that is right
    void (*launch)(SceneWorld&);  ///< null, or starts the motion of the scene's closed twin, in
                                  ///< which dynamic bodies and cloth meet without gravity
    btVector3 eye, target;        ///< of the picture (m)
};

const std::vector<SceneRecipe>& sceneRecipes();

/// The parts of sceneRecipes().
std::vector<SceneRecipe> hangingScenes();
std::vector<SceneRecipe> restingScenes();
std::vector<SceneRecipe> dynamicScenes();
