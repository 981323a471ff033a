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

bool isBulletsDemo(const SceneRecipe& recipe) {
    const auto& demos = bulletsDemos();
    return std::any_of(demos.begin(), demos.end(), [&](const SceneRecipe& demo) {
        return std::strcmp(demo.name, recipe.name) == 0;
    });
}

const std::vector<SceneRecipe>& sceneRecipes() {
    static const auto recipes =
        joined({[] { return smallScenes(); }, [] { return bulletsDemos(); }});
    return recipes;
}
