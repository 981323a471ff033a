#pragma once

#include <vector>

#include "scene_world.h"

/// What does work on a scene besides gravity: a driven body, or air.
enum class OutsideWork { none, at_start, always };

/// One scene.
struct SceneRecipe {
    const char* name;
    const char* sentence;
    void (*build)(SceneWorld& scene);
    bool comes_to_rest;           ///< its last shape is the same for every solver that is right
    void (*launch)(SceneWorld&);  ///< null, or starts the motion of the scene's closed twin, in
                                  ///< which dynamic bodies and cloth meet without gravity
    btVector3 eye, target;        ///< of the picture (m)
    OutsideWork outside_work = OutsideWork::none;
};

/// All of them.
const std::vector<SceneRecipe>& sceneRecipes();

/// What cloth is for, each small enough to look at.
const std::vector<SceneRecipe>& smallScenes();
bool isSmallScene(const SceneRecipe& recipe);
/// The scenes of Bullet's SoftDemo and SimpleCloth that have cloth: their sizes, masses, settings.
const std::vector<SceneRecipe>& bulletsDemos();

/// What cost is judged by.
std::vector<SceneRecipe> manySheets();

/// The parts of smallScenes().
std::vector<SceneRecipe> hangingScenes();
std::vector<SceneRecipe> restingScenes();
std::vector<SceneRecipe> dynamicScenes();

/// The parts of bulletsDemos().
std::vector<SceneRecipe> demoSheets();
std::vector<SceneRecipe> demoFlyers();
std::vector<SceneRecipe> demoClosedBodies();
