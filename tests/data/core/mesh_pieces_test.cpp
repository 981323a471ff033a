#include "data/core/mesh_pieces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/core/errors.h"
#include "data/core/length_units.h"
#include "tests/data/authoring/broken_garments.h"
#include "tests/test_meshes.h"

namespace cloth::mesh_pieces_test {

using namespace cloth::test;

TEST(MeshPieces, AreNumberedInTheOrderOfTheirFaces) {
    const TriMesh ball = icosphere(1);
    const TriMesh all = together(ball, together(scaled(ball, 2.0), scaled(ball, 3.0)));
    const std::vector<int> pieces = face_pieces(all.faces);
    EXPECT_EQ(piece_count(pieces), 3);
    for (size_t f = 0; f < pieces.size(); ++f)
        EXPECT_EQ(pieces[f], static_cast<int>(f) / static_cast<int>(ball.faces.rows()));
    const TriMesh second = piece_of(all, pieces, 1);
    EXPECT_EQ(second.faces, ball.faces);
    EXPECT_EQ(second.vertices, 2.0 * ball.vertices);
    EXPECT_EQ(piece_count(face_pieces(Faces(0, 3))), 0);
}

TEST(MeshPieces, AClosedSurfaceHasNoBorderAndTheVolumeOfItsBall) {
    const TriMesh ball = icosphere(4);
    EXPECT_EQ(border_share(ball.faces), 0.0);
    EXPECT_NEAR(signed_volume(ball), 4.0 / 3.0 * M_PI, 0.02);
    EXPECT_NEAR(signed_volume(turned(ball)), -4.0 / 3.0 * M_PI, 0.02);
    TriMesh away = ball;
    away.vertices.rowwise() += Eigen::RowVector3d(10, -20, 30);
    EXPECT_NEAR(signed_volume(away), signed_volume(ball), 1e-9);
}

TEST(MeshPieces, ASkinWhoseFacesLookInwardsIsRefusedByName) {
    const TriMesh ball = icosphere(2);
    EXPECT_NO_THROW(validate_skin("ball", ball));
    try {
        validate_skin("ball", turned(ball));
        FAIL() << "it was taken";
    } catch (const ArgumentError& error) {
        EXPECT_EQ(std::string(error.what()).find("ball: it is inside out"), 0u) << error.what();
    }
    TriMesh strip = square_mesh(4);
    strip.vertices.rowwise() += Eigen::RowVector3d(0.1, 0.3, 0.7);
    EXPECT_NO_THROW(validate_skin("strip", strip));
    EXPECT_NO_THROW(validate_skin("strip", turned(strip)));
    TriMesh twice{ball.vertices, Faces(2 * ball.faces.rows(), 3)};
    twice.faces << ball.faces, ball.faces;
    EXPECT_THROW(validate_skin("twice", twice), ArgumentError) << "as validate_mesh() does";
}

TEST(MeshPieces, TheBorderShareCountsEdges) {
    Faces square(2, 3);
    square << 0, 1, 2, 0, 2, 3;
    EXPECT_DOUBLE_EQ(border_share(square), 4.0 / 5.0);
}

TEST(LengthUnits, AreKnownByNameAndBySize) {
    EXPECT_EQ(length_unit("cm").metres, 0.01);
    EXPECT_THROW(length_unit("furlong"), ArgumentError);
    const std::vector<LengthUnit> person = plausible_units(175.0, 1.0, 2.5);
    ASSERT_EQ(person.size(), 1u);
    EXPECT_STREQ(person[0].name, "cm");
    EXPECT_TRUE(plausible_units(544.0, 1.0, 2.5).empty());
}

}  // namespace cloth::mesh_pieces_test
