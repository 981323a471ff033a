#include "demos/viewer/vertex_colours.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/proximity/proximity.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::viewer_colours_test {

namespace {

Garment sheet_garment() {
    return {"sheet", cloth::test::sheet(8, 0.3), Fabric::soft_cotton()};
}

}  // namespace

TEST(ViewerColours, AScaleGoesFromStopToStop) {
    for (const ColourScale* scale : {&stretch_scale(), &contact_scale()}) {
        const auto& stops = scale->stops;
        for (size_t k = 1; k < stops.size(); ++k) {
            ASSERT_LT(stops[k - 1].value, stops[k].value);
            const double between = 0.5 * (stops[k - 1].value + stops[k].value);
            const Vec3 mean = 0.5 * (stops[k - 1].colour + stops[k].colour);
            EXPECT_NEAR((scale->colour(between) - mean).norm(), 0.0, 1e-9);
        }
        EXPECT_EQ(scale->colour(-1e9), stops.front().colour);
        EXPECT_EQ(scale->colour(std::nan("")), stops.front().colour);
        EXPECT_EQ(scale->colour(INFINITY), stops.back().colour);
    }
}

TEST(ViewerColours, StretchIsTheLengthOfEdgesOverThatAtRest) {
    const Garment sheet = sheet_garment();
    const VectorX stretch = vertex_stretch(sheet, 1.15 * sheet.rest().vertices);
    EXPECT_NEAR((stretch.array() - 1.15).abs().maxCoeff(), 0.0, 1e-12);
    Proximity proximity;
    const Points colours =
        vertex_colours(ColourMode::stretch, sheet, 1.15 * sheet.rest().vertices, {}, proximity);
    ASSERT_EQ(colours.rows(), sheet.vertex_count());
    EXPECT_NEAR((colours.row(3).transpose() - stretch_scale().colour(1.15)).norm(), 0.0, 1e-9);
}

TEST(ViewerColours, ContactTellsInsideNearAndFar) {
    const Garment sheet = sheet_garment();
    Boundary boundary;
    Obstacle floor;
    floor.shape = ObstacleShape::plane;
    boundary.obstacles.push_back(floor);
    Points x = sheet.rest().vertices;
    x.col(1).setConstant(0.5);
    x(0, 1) = -0.01;
    x(1, 1) = 0.006;
    x(2, 1) = 0.02;
    Proximity proximity;
    const Points colours = vertex_colours(ColourMode::contact, sheet, x, boundary, proximity);
    const auto& scale = contact_scale();
    EXPECT_EQ(Vec3(colours.row(0)), scale.stops.front().colour);
    EXPECT_NEAR((Vec3(colours.row(1)) - scale.colour(0.006)).norm(), 0.0, 1e-9);
    EXPECT_NEAR((Vec3(colours.row(2)) - scale.colour(0.02)).norm(), 0.0, 1e-9);
    EXPECT_EQ(Vec3(colours.row(9)), scale.stops.back().colour);
}

TEST(ViewerColours, GarmentsHaveTheirOwn) {
    const Garment sheet = sheet_garment();
    Proximity proximity;
    EXPECT_EQ(
        vertex_colours(ColourMode::garments, sheet, sheet.rest().vertices, {}, proximity).rows(),
        0);
}

}  // namespace cloth::viewer_colours_test
