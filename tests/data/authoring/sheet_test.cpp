#include "data/authoring/sheet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/authoring/mesh_quality.h"
#include "data/core/errors.h"
#include "data/core/garment.h"

namespace cloth::sheet_test {

TEST(Sheet, HasTheAskedSizeAndVertexCount) {
    for (int target : {9, 60, 400, 2500}) {
        const TriMesh sheet = make_sheet(1.2, 0.8, target, 3);
        EXPECT_NEAR(static_cast<double>(sheet.vertices.rows()), target, 0.03 * target);
        const Vec3 low = sheet.vertices.colwise().minCoeff();
        const Vec3 high = sheet.vertices.colwise().maxCoeff();
        EXPECT_EQ(low, Vec3(-0.6, 0.0, -0.4));
        EXPECT_EQ(high, Vec3(0.6, 0.0, 0.4));
    }
}

TEST(Sheet, TrianglesAreWellShapedAndIrregular) {
    for (unsigned seed : {1u, 2u, 7u, 99u})
        for (int target : {100, 900}) {
            const TriMesh sheet = make_sheet(1.0, 1.0, target, seed);
            EXPECT_GT(smallest_angle(sheet), 20.0) << target << " vertices, seed " << seed;
            EXPECT_NEAR(mean_inner_degree(sheet), 6.0, 0.2);
            const VectorX areas = face_area_vectors(sheet.vertices, sheet.faces).col(1);
            EXPECT_GT(areas.maxCoeff(), 1.2 * areas.minCoeff()) << "a regular grid";
        }
}

TEST(Sheet, IsOneFlatSurfaceThatFacesUp) {
    const TriMesh sheet = make_sheet(0.5, 1.5, 500);
    validate_mesh("sheet", sheet);
    const Points areas = face_area_vectors(sheet.vertices, sheet.faces);
    EXPECT_GT(areas.col(1).minCoeff(), 0.0);
    EXPECT_NEAR(areas.col(1).sum(), 0.75, 1e-12);
    const Topology shape = topology(sheet.faces);
    EXPECT_EQ(shape.components, 1);
    EXPECT_EQ(shape.boundary_loops, 1);
    EXPECT_EQ(shape.euler_characteristic, 1);
    EXPECT_TRUE(shape.manifold);
    EXPECT_TRUE(shape.oriented);
}

TEST(Sheet, EqualArgumentsGiveEqualBitsAndSeedsDiffer) {
    const TriMesh a = make_sheet(1.0, 1.0, 300, 5), b = make_sheet(1.0, 1.0, 300, 5);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.faces, b.faces);
    EXPECT_NE(a.vertices, make_sheet(1.0, 1.0, 300, 6).vertices);
}

TEST(Sheet, CornersAndSidesAreFound) {
    const TriMesh sheet = make_sheet(1.0, 2.0, 400);
    const std::vector<int> corners = sheet_corners(sheet);
    ASSERT_EQ(corners.size(), 4u);
    EXPECT_EQ(Vec3(sheet.vertices.row(corners[0])), Vec3(-0.5, 0, -1));
    EXPECT_EQ(Vec3(sheet.vertices.row(corners[1])), Vec3(0.5, 0, -1));
    EXPECT_EQ(Vec3(sheet.vertices.row(corners[2])), Vec3(-0.5, 0, 1));
    EXPECT_EQ(Vec3(sheet.vertices.row(corners[3])), Vec3(0.5, 0, 1));
    const std::vector<int> back = sheet_side(sheet, SheetSide::back);
    EXPECT_EQ(back.front(), corners[0]);
    EXPECT_EQ(back.back(), corners[1]);
    const std::vector<int> right = sheet_side(sheet, SheetSide::right);
    EXPECT_EQ(right.front(), corners[1]);
    EXPECT_EQ(right.back(), corners[3]);
    size_t border = sheet_side(sheet, SheetSide::left).size() +
                    sheet_side(sheet, SheetSide::front).size() + back.size() + right.size() - 4;
    EXPECT_EQ(border, boundary_loops(sheet.faces)[0].size());
}

TEST(Sheet, WidthsThatDoNotDivideEvenlyHaveNoSliversAtTheirCorners) {
    // width * n / n is not width: one sheet in sixteen was refused
    const TriMesh sheets[] = {
        make_sheet(0.685, 0.940986, 1200, 1332338555), make_sheet(0.411, 0.449387, 300, 472470150),
        make_sheet(0.851, 0.706085, 500, 914478310), make_sheet(0.448, 0.4704, 800, 4200700769)};
    for (const TriMesh& sheet : sheets) EXPECT_GE(smallest_angle(sheet), 20.0);
    for (int k = 0; k < 100; ++k)
        EXPECT_NO_THROW(make_sheet(0.4 + 0.005 * k, 0.5, 300, static_cast<unsigned>(k))) << k;
}

TEST(Sheet, ArgumentsOutOfRangeAreRefused) {
    EXPECT_THROW(make_sheet(0.0, 1.0, 100), ArgumentError);
    EXPECT_THROW(make_sheet(1.0, std::numeric_limits<double>::infinity(), 100), ArgumentError);
    EXPECT_THROW(make_sheet(1.0, 1.0, 4), ArgumentError);
    EXPECT_THROW(make_sheet(1.0, 0.01, 100), ArgumentError);
    EXPECT_THROW(make_sheet(1.0, 0.06, 9), ArgumentError) << "too few for such a strip";
}

}  // namespace cloth::sheet_test
