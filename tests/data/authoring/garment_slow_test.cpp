#include <gtest/gtest.h>

#include <tuple>

#include "data/authoring/make_garment.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "tests/data/authoring/garment_checks.h"

namespace cloth::garment_slow_test {

using namespace cloth::test;

namespace {

const Body& default_body() {
    static const Body body = Body::load_default();
    return body;
}

GarmentRecipe recipe_with(const std::string& name, int vertices) {
    GarmentRecipe recipe = load_garment_recipe(asset_path("garments/" + name + ".json"));
    recipe.target_vertices = vertices;
    return recipe;
}

}  // namespace

TEST(MakeGarment, EveryResolutionHasTheShapeOfATshirt) {
    const SurfaceDistance skin(default_body().rest_mesh());
    for (int vertices : {700, 1500, 12000})
        expect_garment(make_garment(default_body(), recipe_with("tshirt", vertices)).worn, skin,
                       vertices, 4);
}

TEST(MakeGarment, EveryPieceCanBeMadeCoarseAndFine) {
    const SurfaceDistance skin(default_body().rest_mesh());
    const std::tuple<const char*, int, int> pieces[] = {
        {"tank_top", 4, 700}, {"long_top", 4, 1500}, {"shirt", 4, 700},   {"pants", 3, 700},
        {"shorts", 3, 12000}, {"skirt", 2, 6000},    {"dress", 4, 50000},
    };
    for (const auto& [name, openings, vertices] : pieces) {
        const AuthoredGarment garment = make_garment(default_body(), recipe_with(name, vertices));
        expect_garment(garment.worn, skin, vertices, openings);
        EXPECT_GT(smallest_angle({garment.rest, garment.worn.faces}), 20.0) << name;
    }
}

TEST(MakeGarment, EqualArgumentsGiveEqualBits) {
    const AuthoredGarment a = make_garment(default_body(), recipe_with("skirt", 700));
    const AuthoredGarment b = make_garment(default_body(), recipe_with("skirt", 700));
    EXPECT_EQ(a.worn.vertices, b.worn.vertices);
    EXPECT_EQ(a.worn.faces, b.worn.faces);
    EXPECT_EQ(a.rest, b.rest);
}

TEST(MakeGarment, LongerRecipeMakesALongerWiderShirt) {
    GarmentRecipe recipe = recipe_with("tshirt", 700);
    recipe.hem_height = 0.90;
    recipe.ease = 0.025;
    const TriMesh shirt = make_garment(default_body(), recipe).worn;
    expect_garment(shirt, SurfaceDistance(default_body().rest_mesh()), 700, 4);
    EXPECT_NEAR(shirt.vertices.col(1).minCoeff(), 0.90, 1e-3);
}

TEST(MakeGarment, RecipeFollowsABodyOfAnotherSize) {
    const Body tall = default_body().with_rest(1.1 * default_body().rest());
    const TriMesh shorts = make_garment(tall, recipe_with("shorts", 700)).worn;
    expect_garment(shorts, SurfaceDistance(tall.rest_mesh()), 700, 3);
    const BodyLandmarks marks = body_landmarks(tall);
    EXPECT_GT(shorts.vertices.col(1).minCoeff(), marks.knee.y());
    EXPECT_NEAR(shorts.vertices.col(1).maxCoeff(), marks.waist.y(), 0.03);
}

TEST(MakeGarment, RecipeForAnotherBodyIsRefused) {
    GarmentRecipe recipe = recipe_with("tshirt", 700);
    recipe.landmarks["shoulder"].y() = 0.6;  // an arm at the knee
    recipe.landmarks["elbow"].y() = 0.4;
    EXPECT_THROW(make_garment(default_body(), recipe), ArgumentError);
}

}  // namespace cloth::garment_slow_test
