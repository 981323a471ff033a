#include <gtest/gtest.h>

#include "data/authoring/tshirt.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "tests/data/authoring/tshirt_checks.h"

using namespace cloth;
using namespace cloth::test;

namespace {

const TriMesh& default_body() {
    static const TriMesh body = load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    return body;
}

TshirtRecipe recipe_with(int vertices) {
    TshirtRecipe recipe = load_tshirt_recipe(asset_path("garments/tshirt.json"));
    recipe.target_vertices = vertices;
    return recipe;
}

}  // namespace

TEST(MakeTshirt, EveryResolutionHasTheShapeOfATshirt) {
    const SurfaceDistance skin(default_body());
    for (int vertices : {700, 1500, 12000})
        expect_tshirt(make_tshirt(default_body(), recipe_with(vertices)), skin, vertices);
}

TEST(MakeTshirt, EqualArgumentsGiveEqualBits) {
    const TriMesh a = make_tshirt(default_body(), recipe_with(700));
    const TriMesh b = make_tshirt(default_body(), recipe_with(700));
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.faces, b.faces);
}

TEST(MakeTshirt, LongerRecipeMakesALongerWiderShirt) {
    TshirtRecipe recipe = recipe_with(700);
    recipe.hem_height = 0.90;
    recipe.chest_ease = 0.025;
    const TriMesh shirt = make_tshirt(default_body(), recipe);
    expect_tshirt(shirt, SurfaceDistance(default_body()), 700);
    EXPECT_NEAR(shirt.vertices.col(1).minCoeff(), 0.90, 1e-3);
}

TEST(MakeTshirt, RecipeForAnotherBodyIsRefused) {
    TshirtRecipe recipe = recipe_with(700);
    recipe.shoulder.y() = 0.6;  // an arm at the knee
    recipe.elbow.y() = 0.4;
    EXPECT_THROW(make_tshirt(default_body(), recipe), ArgumentError);
}
