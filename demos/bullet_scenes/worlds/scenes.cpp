#include "scenes.h"

const std::vector<SceneRecipe>& sceneRecipes() {
    static const std::vector<SceneRecipe> recipes = [] {
        std::vector<SceneRecipe> all = hangingScenes();
        for (const SceneRecipe& recipe : restingScenes()) all.push_back(recipe);
        for (const SceneRecipe& recipe : dynamicScenes()) all.push_back(recipe);
        return all;
    }();
    return recipes;
}
