// Bad and degenerate input: the per-frame path never throws and never answers NaN.

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "collision/proximity/proximity.h"
#include "data/core/errors.h"
#include "tests/test_meshes.h"

namespace cloth::proximity_robustness_test {
namespace {

using namespace test;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

void expect_sane(const SurfaceContacts& contacts) {
    for (const Points* rows : {&contacts.barycentric, &contacts.point0, &contacts.point1,
                               &contacts.normal0, &contacts.normal1})
        EXPECT_TRUE(rows->allFinite());
    EXPECT_FALSE(contacts.distance.array().isNaN().any());
    for (Eigen::Index i = 0; i < contacts.distance.size(); ++i) {
        if (!contacts.has(i)) continue;
        EXPECT_NEAR(contacts.normal0.row(i).norm(), 1.0, 1e-12);
        EXPECT_NEAR(contacts.normal1.row(i).norm(), 1.0, 1e-12);
    }
}

SurfaceContacts contacts_of(const Points& x, const Boundary& boundary, double radius = 0.5) {
    Proximity proximity({radius, 0});
    SurfaceContacts contacts;
    proximity.query(x, boundary, contacts);
    expect_sane(contacts);
    return contacts;
}

TEST(ProximityRobustness, PointsThatAreNotFiniteHaveNoContact) {
    Points x(5, 3);
    x << nan, 0, 0, 0, inf, 0, 1.1, 0, 0, 0, 0, -inf, 1e300, 1e300, 1e300;
    const Obstacle plane = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    EXPECT_EQ(contacts_of(x, boundary_of({mesh_obstacle(cube())})).obstacle,
              (std::vector<int>{-1, -1, 0, -1, -1}));
    EXPECT_EQ(contacts_of(x, boundary_of({plane})).obstacle, (std::vector<int>{-1, -1, 0, -1, -1}));
}

/// Collapsed edges make faces without area; the rest of the surface answers as before.
TEST(ProximityRobustness, FacesWithoutAreaArePassedOver) {
    std::mt19937 random(1);
    TriMesh mesh = icosphere(2);
    Obstacle obstacle = mesh_obstacle(mesh);
    for (int i = 0; i < 8; ++i) {
        const auto face = static_cast<Eigen::Index>(random() % size_t(mesh.faces.rows()));
        obstacle.x0.row(mesh.faces(face, 0)) = obstacle.x0.row(mesh.faces(face, 1));
    }
    obstacle.x1 = obstacle.x0;
    const Points x = random_points(random, 800, 1.2);
    const Boundary boundary = boundary_of({obstacle});
    const SurfaceContacts contacts = contacts_of(x, boundary);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double expected =
            brute_force_signed_distance(boundary, StepEnd::start, x.row(i).transpose());
        if (!contacts.has(i)) continue;
        EXPECT_NEAR(contacts.distance[i], expected, 1e-12);
    }
}

TEST(ProximityRobustness, AMeshCollapsedToAPointOrALineHasNoContacts) {
    const Points x = Points::Zero(3, 3);
    Obstacle point = mesh_obstacle(icosphere(1)), line = mesh_obstacle(icosphere(1));
    point.x0.setConstant(0.1);
    point.x1 = point.x0;
    line.x0.leftCols(2).setZero();
    line.x1 = line.x0;
    EXPECT_EQ(contacts_of(x, boundary_of({point, line})).obstacle, (std::vector<int>{-1, -1, -1}));
}

TEST(ProximityRobustness, AFaceThatCollapsesDuringTheStepKeepsItsNormal) {
    Obstacle obstacle = mesh_obstacle(cube());
    obstacle.x1.setConstant(0.25);
    Points x(1, 3);
    x << 1.1, 0.2, 0.3;
    const SurfaceContacts contacts = contacts_of(x, boundary_of({obstacle}));
    ASSERT_TRUE(contacts.has(0));
    EXPECT_EQ(Vec3(contacts.normal1.row(0)), Vec3(1, 0, 0));
    EXPECT_LT((contacts.point1.row(0).array() - 0.25).abs().maxCoeff(), 1e-15);
}

/// A hole where a vertex is not finite; faces elsewhere still answer.
TEST(ProximityRobustness, VerticesThatAreNotFiniteOnlyTakeTheirFaces) {
    std::mt19937 random(2);
    const Points x = random_points(random, 500, 1.2);
    for (const double bad : {nan, inf, -inf}) {
        Obstacle obstacle = mesh_obstacle(icosphere(2));
        obstacle.x0(17, 1) = bad;
        obstacle.x1(40, 2) = bad;
        const SurfaceContacts contacts = contacts_of(x, boundary_of({obstacle}));
        const TriMesh mesh{obstacle.x0, *obstacle.faces};
        int found = 0;
        for (Eigen::Index i = 0; i < x.rows(); ++i) {
            if (!contacts.has(i)) continue;
            ++found;
            EXPECT_NEAR(std::abs(contacts.distance[i]),
                        brute_force_closest(mesh, x.row(i).transpose())->distance, 1e-12);
        }
        EXPECT_GT(found, 100);
    }
}

/// Shapes of physics engines often come as unindexed triangles.
TEST(ProximityRobustness, UnindexedTrianglesAreAClosedSurface) {
    std::mt19937 random(3);
    const TriMesh mesh = roughened(icosphere(2), 0.3, 2);
    const Points x = random_points(random, 800, 1.3);
    const SurfaceContacts indexed = contacts_of(x, boundary_of({mesh_obstacle(mesh)}));
    const SurfaceContacts soup = contacts_of(x, boundary_of({mesh_obstacle(triangle_soup(mesh))}));
    EXPECT_EQ(indexed.distance, soup.distance);
    EXPECT_EQ(indexed.normal0, soup.normal0);
}

TEST(ProximityRobustness, UnusableObstaclesArePassedOverAndNamedBySetUp) {
    std::vector<Obstacle> bad(7, mesh_obstacle(cube()));
    bad[0].faces = nullptr;
    bad[1].faces = std::make_shared<const Faces>(Faces(0, 3));
    bad[2].x1.conservativeResize(4, 3);
    Faces out_of_range = *bad[3].faces;
    out_of_range(5, 1) = 8;
    bad[3].faces = std::make_shared<const Faces>(out_of_range);
    out_of_range(5, 1) = -1;
    bad[4].faces = std::make_shared<const Faces>(out_of_range);
    bad[5].x0.resize(0, 3);
    bad[5].x1.resize(0, 3);
    bad[6] = primitive(ObstacleShape::sphere, Vec3::Zero(), nan);
    Points x(1, 3);
    x << 1.1, 0, 0;
    for (const Obstacle& obstacle : bad) {
        EXPECT_FALSE(contacts_of(x, boundary_of({obstacle})).has(0));
        try {
            check_obstacles(boundary_of({mesh_obstacle(cube()), obstacle}));
            ADD_FAILURE() << "not refused";
        } catch (const ArgumentError& error) {
            EXPECT_NE(std::string(error.what()).find("obstacles[1]"), std::string::npos);
        }
    }
    bad.push_back(mesh_obstacle(cube()));
    EXPECT_EQ(contacts_of(x, boundary_of(bad)).obstacle[0], 7);
    EXPECT_NO_THROW(check_obstacles(boundary_of({mesh_obstacle(cube())})));
}

TEST(ProximityRobustness, AMeshThatLosesVerticesIsPassedOver) {
    Proximity proximity;
    SurfaceContacts contacts;
    Points x(1, 3);
    x << 1.05, 0, 0;
    Obstacle obstacle = mesh_obstacle(cube());
    proximity.query(x, boundary_of({obstacle}), contacts);
    EXPECT_TRUE(contacts.has(0));
    obstacle.x0.conservativeResize(5, 3);
    obstacle.x1.conservativeResize(5, 3);
    proximity.query(x, boundary_of({obstacle}), contacts);
    EXPECT_FALSE(contacts.has(0));
}

TEST(ProximityRobustness, NoPointsIsNoProblem) {
    const SurfaceContacts contacts =
        contacts_of(Points(0, 3), boundary_of({mesh_obstacle(cube())}));
    EXPECT_EQ(contacts.distance.size(), 0);
}

TEST(ProximityRobustness, ASingleFaceHasTwoSides) {
    TriMesh mesh{Points(3, 3), Faces(1, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0;
    mesh.faces << 0, 1, 2;
    Points x(2, 3);
    x << 0.2, 0.2, 0.1, 0.2, 0.2, -0.1;
    const SurfaceContacts contacts = contacts_of(x, boundary_of({mesh_obstacle(mesh)}));
    EXPECT_NEAR(contacts.distance[0], 0.1, 1e-12);
    EXPECT_NEAR(contacts.distance[1], -0.1, 1e-12);
}

TEST(ProximityRobustness, ABadRadiusIsRefused) {
    EXPECT_THROW(Proximity({0.0, 0}), ArgumentError);
    EXPECT_THROW(Proximity({nan, 0}), ArgumentError);
    EXPECT_THROW(Proximity({inf, 0}), ArgumentError);
}

}  // namespace
}  // namespace cloth::proximity_robustness_test
