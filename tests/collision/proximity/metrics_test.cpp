#include "collision/proximity/metrics.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::metrics_test {
namespace {

using namespace test;

/// One square metre in the x-z plane, n x n squares of two triangles.
Garment sheet(int n) {
    TriMesh mesh{Points((n + 1) * (n + 1), 3), Faces(2 * n * n, 3)};
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j)
            mesh.vertices.row(i * (n + 1) + j) << double(i) / n, 0.0, double(j) / n;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int at = i * (n + 1) + j, across = at + n + 2;
            mesh.faces.row(2 * (i * n + j)) << at, at + 1, across;
            mesh.faces.row(2 * (i * n + j) + 1) << at, across, at + n + 1;
        }
    return Garment("sheet", mesh, Fabric());
}

TEST(Metrics, PenetrationIntoAFloorIsTheKnownDepth) {
    const Garment garment = sheet(4);
    Points x = garment.rest().vertices;  // rises from -0.2 to 0.8 along x
    x.col(1) = x.col(0).array() - 0.2;
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    floor.pose0 = pose_of({0, -9, 0});
    Proximity proximity({1.0, 0});
    const auto measured = measure_penetration(proximity, boundary_of({floor}), garment, x);
    EXPECT_DOUBLE_EQ(measured.max_depth, 0.2);
    EXPECT_DOUBLE_EQ(measured.vertex_depth, 0.2);
    EXPECT_DOUBLE_EQ(measured.fraction_inside, 5.0 / 25);
    // Midpoints at x = 0 (4 edges) and x = 1/8 (5 across, 4 diagonals) of 56 edges; centres at
    // x = 1/12 and 2/12 of 32 faces.
    EXPECT_DOUBLE_EQ(measured.edge_fraction, 13.0 / 56);
    EXPECT_DOUBLE_EQ(measured.face_fraction, 8.0 / 32);
    const auto before =
        measure_penetration(proximity, boundary_of({floor}), garment, x, StepEnd::start);
    EXPECT_EQ(before.max_depth, 0.0);
    EXPECT_EQ(before.fraction_inside, 0.0);
}

/// A pole between the vertices: only edges and faces see it.
TEST(Metrics, PenetrationBetweenVerticesIsSeen) {
    const Garment garment = sheet(1);
    Obstacle ball = primitive(ObstacleShape::sphere, Vec3::Zero(), 0.1);
    ball.pose0 = ball.pose1 = pose_of({0.5, -0.05, 0.5});
    Proximity proximity({1.0, 0});
    const auto measured =
        measure_penetration(proximity, boundary_of({ball}), garment, garment.rest().vertices);
    EXPECT_EQ(measured.vertex_depth, 0.0);
    EXPECT_EQ(measured.fraction_inside, 0.0);
    EXPECT_NEAR(measured.max_depth, 0.05, 1e-12);
    EXPECT_DOUBLE_EQ(measured.edge_fraction, 1.0 / 5);
}

TEST(Metrics, ShallowPenetrationDoesNotCountAsInside) {
    const Garment garment = sheet(2);
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    floor.pose1 = pose_of({0, 0.9e-3, 0});
    Proximity proximity;
    const auto measured =
        measure_penetration(proximity, boundary_of({floor}), garment, garment.rest().vertices);
    EXPECT_NEAR(measured.max_depth, 0.9e-3, 1e-12);
    EXPECT_EQ(measured.fraction_inside, 0.0);
}

TEST(Metrics, StretchOfAScaledSheetIsTheScale) {
    const Garment garment = sheet(3);
    const StretchStatistics stretch = measure_stretch(garment, 1.25 * garment.rest().vertices);
    EXPECT_NEAR(stretch.p50, 1.25, 1e-12);
    EXPECT_NEAR(stretch.p99, 1.25, 1e-12);
    EXPECT_NEAR(stretch.max, 1.25, 1e-12);
}

TEST(Metrics, StretchPercentilesSeparateOneLongEdge) {
    const Garment garment = sheet(12);  // 456 edges: two of them are below the 99th percentile
    Points x = garment.rest().vertices;
    x(0, 0) -= 1.0 / 12;  // a corner: one side doubled, the side across and the diagonal longer
    const StretchStatistics stretch = measure_stretch(garment, x);
    EXPECT_NEAR(stretch.p50, 1.0, 1e-12);
    EXPECT_NEAR(stretch.p99, 1.0, 1e-12);
    EXPECT_NEAR(stretch.max, 2.0, 1e-12);
    x(50, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(measure_stretch(garment, x).max, std::numeric_limits<double>::infinity());
}

TEST(Metrics, JitterIsTheAmplitudeOfAlternation) {
    std::mt19937 random(1);
    const Points x0 = random_points(random, 20, 1.0), v = random_points(random, 20, 0.1);
    const Points a = random_points(random, 20, 0.01);
    JitterMeter smooth, shaken;
    for (int t = 0; t < 10; ++t) {
        const Points x = x0 + t * v + t * t * a;
        smooth.add(x);
        shaken.add(x.array() + (t % 2 ? 0.003 : -0.003) / std::sqrt(3.0));
        if (t < 3) {
            EXPECT_EQ(shaken.mean(), 0.0) << "three frames are not enough";
        }
    }
    EXPECT_NEAR(smooth.mean(), 0.0, 1e-15);
    EXPECT_NEAR(shaken.mean(), 0.003, 1e-12);
    EXPECT_NEAR(shaken.last(), 0.003, 1e-12);
}

}  // namespace
}  // namespace cloth::metrics_test
