#include "data/body/garment_sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "data/body/garment_place.h"
#include "data/core/mesh_repair.h"
#include "tests/data/authoring/broken_garments.h"

namespace cloth::garment_sides_test {

using namespace cloth::test;

namespace {

const SurfaceDistance& skin() {
    static const SurfaceDistance distance{person()};
    return distance;
}

}  // namespace

TEST(GarmentSides, GarmentsOfTheWardrobeLookOutwardsAndAreOneLayer) {
    for (const char* name : {"tshirt_1000", "pants_1000", "skirt_1000", "dress_1000"}) {
        TriMesh garment = worn_garment(name);
        const Faces faces = garment.faces;
        EXPECT_EQ(turn_outwards(garment, skin()), 0) << name;
        EXPECT_EQ(garment.faces, faces) << name;
        EXPECT_FALSE(find_inner_side(garment, skin())) << name;
        EXPECT_GT(outwardness(garment, skin()).mean(), 0.7) << name;
    }
}

TEST(GarmentSides, WhatIsInsideOutIsTurned) {
    TriMesh garment = turned(worn_garment("tshirt_1000"));
    EXPECT_EQ(turn_outwards(garment, skin()), 1);
    EXPECT_EQ(garment.faces, worn_garment("tshirt_1000").faces);
}

TEST(GarmentSides, TheInnerSideOfAShellIsFoundWithItsRim) {
    for (const double thickness : {0.001, 0.003}) {
        const TriMesh outer = worn_garment("dress_1000");
        const TriMesh shell = thick(outer, thickness);
        EXPECT_EQ(border_share(shell.faces), 0.0);
        const auto side = find_inner_side(shell, skin());
        ASSERT_TRUE(side);
        EXPECT_NEAR(side->share, 0.5, 0.02);
        EXPECT_NEAR(side->thickness, thickness, 0.3 * thickness);
        int wrong = 0;
        for (Eigen::Index f = 0; f < shell.faces.rows(); ++f)
            wrong += (f < outer.faces.rows()) == (side->is_inner[static_cast<size_t>(f)] != 0);
        EXPECT_LT(wrong, 0.01 * static_cast<double>(shell.faces.rows()));
    }
}

TEST(GarmentSides, ALiningIsThePieceBelow) {
    const TriMesh outer = worn_garment("skirt_1000");
    TriMesh lining = outer;
    lining.vertices -= 0.003 * vertex_normals(outer.vertices, outer.faces);
    const TriMesh both = together(lining, outer);
    const std::vector<Lining> found = find_linings(both, face_pieces(both.faces), skin());
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].piece, 0);
    EXPECT_EQ(found[0].below, 1);
    EXPECT_NEAR(found[0].gap, 0.003, 5e-4);
}

TEST(GarmentSides, AShirtOverTrousersIsNoLining) {
    const TriMesh both = together(worn_garment("tshirt_1000"), worn_garment("pants_1000"));
    EXPECT_TRUE(find_linings(both, face_pieces(both.faces), skin()).empty());
}

TEST(GarmentPlace, GarmentsOfTheWardrobeAreInPlaceInMetresOnly) {
    for (const char* name : {"tshirt_1000", "pants_1000", "skirt_1000", "dress_1000"}) {
        const Points x = worn_garment(name).vertices;
        EXPECT_TRUE(is_in_place(x, person().vertices)) << name;
        for (const double factor : {100.0, 39.37, 10.0, 0.01})
            EXPECT_FALSE(is_in_place(factor * x, person().vertices)) << name << " x " << factor;
    }
}

TEST(GarmentPlace, TheUnitAndTheUpAxisAreGuessed) {
    const Points x = worn_garment("tshirt_1000").vertices;
    for (const LengthUnit& unit : length_units()) {
        const auto guesses = guess_place(x / unit.metres, person().vertices);
        EXPECT_TRUE(std::any_of(guesses.begin(), guesses.end(), [&](const PlaceGuess& guess) {
            return guess.unit.name == std::string(unit.name) && !guess.z_up;
        })) << unit.name;
        EXPECT_LE(guesses.size(), 2u) << "inches and centimetres may both fit";
    }
    Points z_up(x.rows(), 3);
    z_up << 100 * x.col(0), -100 * x.col(2), 100 * x.col(1);
    const auto guesses = guess_place(z_up, person().vertices);
    ASSERT_GE(guesses.size(), 1u);
    EXPECT_STREQ(guesses[0].unit.name, "cm");
    EXPECT_TRUE(guesses[0].z_up);
    EXPECT_TRUE(with_y_up(z_up).isApprox(100 * x));
}

TEST(GarmentPlace, WhatIsElsewhereMayBeOfTheRightSize) {
    Points x = 100 * worn_garment("tshirt_1000").vertices;
    x.col(1).array() += 1000;
    EXPECT_TRUE(guess_place(x, person().vertices).empty());
    const auto sizes = plausible_sizes(x, person().vertices);
    ASSERT_GE(sizes.size(), 1u);
    EXPECT_STREQ(sizes[0].name, "cm");
}

}  // namespace cloth::garment_sides_test
