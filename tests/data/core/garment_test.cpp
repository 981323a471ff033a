#include "data/core/garment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/core/errors.h"

namespace cloth::garment_test {

namespace {

TriMesh unit_square() {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 0, 2, 3;
    return mesh;
}

}  // namespace

TEST(Garment, MassIsDensityTimesArea) {
    const Garment garment("square", unit_square(), Fabric::soft_cotton());
    EXPECT_NEAR(garment.masses().sum(), Fabric::soft_cotton().density * 1.0, 1e-12);
}

TEST(Garment, SquareHasFiveEdgesAndOneFlatHinge) {
    const Garment garment("square", unit_square(), Fabric::soft_cotton());
    EXPECT_EQ(garment.edges().size(), 5u);
    ASSERT_EQ(garment.hinges().size(), 1u);
    EXPECT_NEAR(dihedral_angle(garment.rest().vertices, garment.hinges()[0]), 0.0, 1e-12);
}

TEST(Garment, RightAngleFoldHasDihedralOfHalfPi) {
    TriMesh mesh = unit_square();
    mesh.vertices.row(3) = Vec3(0.5, 0.5, std::sqrt(0.5)).transpose();
    const Garment garment("fold", mesh, Fabric::soft_cotton(), {}, true);
    EXPECT_NEAR(std::abs(garment.hinge_rest_angles()[0]), M_PI / 2, 1e-9);
}

TEST(Garment, RefusesBadInputByName) {
    TriMesh nan = unit_square();
    nan.vertices(2, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Garment("nan", nan, {}), ArgumentError);

    TriMesh flat = unit_square();
    flat.vertices.row(1) = flat.vertices.row(2);
    EXPECT_THROW(Garment("flat", flat, {}), ArgumentError);

    try {
        Garment("pins", unit_square(), {}, {7});
        FAIL() << "a pin that is no vertex was accepted";
    } catch (const ArgumentError& error) {
        EXPECT_NE(std::string(error.what()).find("pin 7"), std::string::npos);
    }
}

}  // namespace cloth::garment_test
