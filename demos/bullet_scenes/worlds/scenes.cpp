#include "scenes.h"

#include <algorithm>
#include <cstring>

namespace {

using Part = std::vector<SceneRecipe> (*)();

std::vector<SceneRecipe> joined(std::initializer_list<Part> parts) {
    std::vector<SceneRecipe> all;
    for (Part part : parts)
        for (const SceneRecipe& recipe : part()) all.push_back(recipe);
    return all;
}

}  // namespace

const std::vector<SceneRecipe>& smallScenes() {
    static const auto recipes = joined({hangingScenes, restingScenes, dynamicScenes});
    return recipes;
}

const std::vector<SceneRecipe>& bulletsDemos() {
    static const auto recipes = joined({demoSheets, demoFlyers, demoClosedBodies});
    return recipes;
}

bool isSmallScene(const SceneRecipe& recipe) {
    const auto& small = smallScenes();
    return std::any_of(small.begin(), small.end(), [&](const SceneRecipe& one) {
        return std::strcmp(one.name, recipe.name) == 0;
    });
}

const std::vector<SceneRecipe>& sceneRecipes() {
    static const auto recipes =
        joined({[] { return smallScenes(); }, [] { return bulletsDemos(); }, manySheets});
    return recipes;
}
