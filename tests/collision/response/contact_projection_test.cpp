#include "collision/response/contact_projection.h"

#include <gtest/gtest.h>

#include "collision/proximity/brute_force.h"
#include "collision/proximity/metrics.h"
#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "tests/test_meshes.h"

namespace cloth::contact_projection_test {
namespace {

using namespace test;

constexpr double distance = 5e-4;  // of vertices (m)

Garment sheet(int vertices = 300, std::vector<int> pins = {}) {
    return Garment("sheet", make_sheet(0.5, 0.5, vertices), Fabric::soft_cotton(), std::move(pins));
}

/// Deepest vertex, edge midpoint or face centre by brute force (m), negative outside.
double oracle_depth(const Garment& garment, const Points& x, const Boundary& boundary) {
    double depth = -1.0;
    const auto sample = [&](const Vec3& at) {
        depth = std::max(depth, -brute_force_signed_distance(boundary, StepEnd::end, at));
    };
    for (Eigen::Index i = 0; i < x.rows(); ++i) sample(x.row(i));
    for (const auto& [a, b] : garment.edges()) sample(0.5 * (x.row(a) + x.row(b)));
    const Faces& faces = garment.rest().faces;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        sample((x.row(faces(f, 0)) + x.row(faces(f, 1)) + x.row(faces(f, 2))) / 3.0);
    return depth;
}

ResolveReport resolve(const Garment& garment, const Boundary& boundary, Points& x,
                      int threads = 0) {
    Proximity proximity({0.1, threads});
    SurfaceContacts contacts;
    return ContactProjection(garment).resolve(proximity, boundary, distance, x, contacts);
}

double largest_move(const Points& a, const Points& b) {
    return (a - b).rowwise().norm().maxCoeff();
}

Obstacle at(Obstacle obstacle, const Pose& pose) {
    obstacle.pose0 = obstacle.pose1 = pose;
    return obstacle;
}

/// An obstacle smaller than the triangles of the sheet y = 0 that sticks out of it by some mm.
struct Bump {
    std::string name;
    Obstacle obstacle;
};

std::vector<Bump> bumps() {
    const Pose lying = pose_of({0.003, -0.004, 0.0}, M_PI / 2, {1, 0, 0.2});
    Pose ridge = pose_of({0, -0.1 * std::sqrt(2.0) + 0.006, 0}, M_PI / 4, {0, 0, 1});
    TriMesh ball = icosphere(2);
    ball.vertices = (0.012 * ball.vertices).rowwise() + Eigen::RowVector3d(0.002, -0.005, 0.001);
    return {{"ThinCapsule", at(primitive(ObstacleShape::capsule, {0, 0.15, 0}, 0.01), lying)},
            {"BoxEdge", at(primitive(ObstacleShape::box, {0.1, 0.1, 0.1}, 0.0), ridge)},
            {"SmallSphere", at(primitive(ObstacleShape::sphere, Vec3::Zero(), 0.012),
                               pose_of({0.002, -0.005, 0.001}))},
            {"SmallBall", mesh_obstacle(ball)}};
}

class CoarseSheet : public ::testing::TestWithParam<Bump> {};

TEST_P(CoarseSheet, IsLiftedOffWhatIsSmallerThanItsTriangles) {
    const Garment garment = sheet();
    ASSERT_GT(garment.mean_edge_length(), 0.025);
    const Boundary boundary = boundary_of({GetParam().obstacle});
    const Points before = garment.rest().vertices;
    Points x = before;
    const double depth = oracle_depth(garment, x, boundary);
    ASSERT_GT(depth, 2e-3);
    const ResolveReport report = resolve(garment, boundary, x);
    EXPECT_LT(oracle_depth(garment, x, boundary), 1e-3);
    EXPECT_LT(report.deepest_after(), 1e-3);
    EXPECT_LT(largest_move(x, before), 4 * depth);
    EXPECT_LT(measure_stretch(garment, x).max, 1.15);
    EXPECT_GT(((x - before).rowwise().norm().array() == 0.0).count(), x.rows() / 2)
        << "far away nothing moves";
}

INSTANTIATE_TEST_SUITE_P(Bumps, CoarseSheet, ::testing::ValuesIn(bumps()),
                         [](const auto& bump) { return bump.param.name; });

TEST(ContactProjection, VerticesAloneAreKeptOutIfAsked) {
    const Garment garment = sheet();
    const Boundary boundary = boundary_of({bumps()[2].obstacle});
    Proximity proximity;
    SurfaceContacts contacts;
    ContactProjection projection(garment);
    projection.set_surface(false);
    Points x = garment.rest().vertices;
    const ResolveReport report = projection.resolve(proximity, boundary, distance, x, contacts);
    EXPECT_LE(report.deepest_after(), 0.0);
    EXPECT_GT(oracle_depth(garment, x, boundary), 1e-3);
    projection.set_surface(true);
    projection.resolve(proximity, boundary, distance, x, contacts);
    EXPECT_LT(oracle_depth(garment, x, boundary), 1e-3);
}

TEST(ContactProjection, TheReportAgreesWithBruteForce) {
    const Garment garment = sheet(200);
    TriMesh ball = roughened(icosphere(3), 0.02, 5);
    ball.vertices *= 0.15;
    const Boundary boundary = boundary_of({mesh_obstacle(ball)});
    for (const double height : {0.145, 0.135, 0.12}) {
        Points x = garment.rest().vertices;
        x.col(1).array() += height;
        const ResolveReport report = resolve(garment, boundary, x);
        const double depth = oracle_depth(garment, x, boundary);
        EXPECT_LT(depth, 1e-3);
        if (report.deepest_after() > 0.0) {
            EXPECT_NEAR(report.deepest_after(), depth, 1e-9);
        }
        EXPECT_GT(report.surface_iterations, 0);
    }
}

TEST(ContactProjection, ASheetThatStartsInsideASphereIsOutAfterOneFrame) {
    const Garment garment = sheet(800);
    const Boundary boundary =
        boundary_of({at(primitive(ObstacleShape::sphere, Vec3::Zero(), 0.2), pose_of({0, 0, 0}))});
    Points x = garment.rest().vertices;
    x.col(1).array() += 0.17;
    EXPECT_NEAR(oracle_depth(garment, x, boundary), 0.03, 2e-3);
    resolve(garment, boundary, x);
    EXPECT_LT(oracle_depth(garment, x, boundary), 1e-3);
    EXPECT_LT(measure_stretch(garment, x).max, 1.3);
}

TEST(ContactProjection, OutsideNothingMoves) {
    const Garment garment = sheet();
    TriMesh ball = icosphere(2);
    ball.vertices *= 0.1;
    ball.vertices.col(1).array() -= 0.101;
    Points x = garment.rest().vertices;
    const ResolveReport report = resolve(garment, boundary_of({mesh_obstacle(ball)}), x);
    EXPECT_EQ(x, garment.rest().vertices);
    EXPECT_EQ(report.surface_iterations + report.iterations, 0);
    EXPECT_EQ(resolve(garment, Boundary(), x).surface_iterations, 0);
    EXPECT_EQ(x, garment.rest().vertices);
}

TEST(ContactProjection, PinnedVerticesStayAndTheirNeighboursMakeRoom) {
    const Garment free = sheet();
    const Boundary boundary = boundary_of({bumps()[2].obstacle});
    Points x = free.rest().vertices;
    resolve(free, boundary, x);
    std::vector<int> pins;
    for (Eigen::Index i = 0; i < x.rows() && pins.empty(); ++i)
        if (x.row(i) != free.rest().vertices.row(i)) pins = {static_cast<int>(i)};
    ASSERT_FALSE(pins.empty());
    const Garment garment = sheet(300, pins);
    x = garment.rest().vertices;
    resolve(garment, boundary, x);
    EXPECT_EQ(Vec3(x.row(pins[0])), Vec3(garment.rest().vertices.row(pins[0])));
    EXPECT_LT(oracle_depth(garment, x, boundary), 1e-3);
}

TEST(ContactProjection, TheNumberOfThreadsChangesNothing) {
    const Garment garment = sheet(3000);
    TriMesh ball = roughened(icosphere(4), 0.02, 5);
    ball.vertices *= 0.15;
    const Boundary boundary = boundary_of({mesh_obstacle(ball)});
    Points start = garment.rest().vertices;
    start.col(1).array() += 0.13;
    Points expected = start;
    resolve(garment, boundary, expected, 1);
    EXPECT_GT(largest_move(start, expected), 0.01);
    for (const int threads : {2, 3, 4}) {
        Points x = start;
        resolve(garment, boundary, x, threads);
        EXPECT_EQ(x, expected) << threads;
    }
}

TEST(ContactProjection, WhatItDidBeforeChangesNothing) {
    const Garment garment = sheet();
    Proximity proximity;
    SurfaceContacts contacts;
    ContactProjection resolver(garment);
    for (const Bump& bump : bumps()) {
        const Boundary boundary = boundary_of({bump.obstacle});
        Points x = garment.rest().vertices, fresh = x;
        resolver.resolve(proximity, boundary, distance, x, contacts);
        resolve(garment, boundary, fresh);
        EXPECT_EQ(x, fresh) << bump.name;
    }
}

TEST(ContactProjection, BetweenTwoBoxesThatOverlapItSaysThatItFailed) {
    const Garment garment = sheet();
    const Obstacle box = primitive(ObstacleShape::box, {0.4, 0.1, 0.4}, 0.0);
    const Boundary boundary =
        boundary_of({at(box, pose_of({0, 0.095, 0})), at(box, pose_of({0, -0.096, 0}))});
    Points x = garment.rest().vertices;
    const ResolveReport report = resolve(garment, boundary, x);
    EXPECT_TRUE(x.allFinite());
    EXPECT_GT(report.deepest_after(), 1e-3);
    EXPECT_LE(report.deepest_after(), 0.011);
    EXPECT_LT(largest_move(x, garment.rest().vertices), 0.05);
}

/// One body whose parts overlap by 8 mm: the skins face each other through a slab, and vertices on
/// both of them are outside by the sign of their nearest point.
TEST(ContactProjection, AcrossOverlappingPartsOfABodyAllGoToOneSide) {
    const Garment garment = sheet();
    TriMesh body{Points(16, 3), Faces(24, 3)};
    const TriMesh part = cube();
    for (const int k : {0, 1}) {
        body.vertices.middleRows(8 * k, 8) = 0.1 * part.vertices;
        body.vertices.middleRows(8 * k, 8).col(1).array() += k == 0 ? -0.096 : 0.096;
        body.faces.middleRows(12 * k, 12) = part.faces.array() + 8 * k;
    }
    const Boundary boundary = boundary_of({mesh_obstacle(body)});
    std::mt19937 random(3);
    Points x = garment.rest().vertices;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        x(i, 1) = x(i, 0) > 0.05 ? 5e-3 : -5e-3 + uniform(random, 0.0, 3e-3);
    const Points before = x;
    const ResolveReport report = resolve(garment, boundary, x);
    EXPECT_GT(report.max_surface_depth_before, 2e-3);
    EXPECT_LT(report.deepest_after(), 1e-3);
    EXPECT_LT(largest_move(x, before), 0.03);
}

/// Of the sheet over a place in the plane y = 0 (m).
double height_over(const Garment& garment, const Points& x, const Vec3& place) {
    const Faces& faces = garment.rest().faces;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        Eigen::Matrix3d corners;  // in its columns, with 1 for the height
        for (int k = 0; k < 3; ++k) corners.col(k) << x(faces(f, k), 0), 1.0, x(faces(f, k), 2);
        const Vec3 weight = corners.colPivHouseholderQr().solve(Vec3(place.x(), 1.0, place.z()));
        if (!(weight.minCoeff() >= 0.0)) continue;
        return weight[0] * x(faces(f, 0), 1) + weight[1] * x(faces(f, 1), 1) +
               weight[2] * x(faces(f, 2), 1);
    }
    return -1.0;
}

/// A finger of 16 mm that pierces a face from below, up to 12 mm above the sheet y = 0.
TEST(ContactProjection, PiercedFacesLeaveByTheWayThatIsKnown) {
    const Garment garment = sheet();
    const Points& before = garment.rest().vertices;
    const Faces& faces = garment.rest().faces;
    const double tip = 0.012;
    int pierced = 0;
    for (const int face : {100, 200, 300, 400}) {
        const Vec3 centre =
            (before.row(faces(face, 0)) + before.row(faces(face, 1)) + before.row(faces(face, 2))) /
            3.0;
        TriMesh finger = cube();
        finger.vertices.array().rowwise() *= Eigen::RowVector3d(0.008, 0.05, 0.008).array();
        finger.vertices.rowwise() += (centre + Vec3(0, tip - 0.05, 0)).transpose();
        const Boundary boundary = boundary_of({mesh_obstacle(finger)});
        const auto resolved = [&](const ContactProjection::WayIn& way_in) {
            Points x = before;
            Proximity proximity;
            SurfaceContacts contacts;
            ContactProjection(garment).resolve(proximity, boundary, distance, x, contacts, way_in);
            return x;
        };
        if (height_over(garment, resolved(nullptr), centre) < 0.5 * tip) ++pierced;
        const Points x = resolved([&](const SurfaceSamples& samples, int sample) {
            EXPECT_LT(samples.contacts().distance[sample], 0.0) << "asked of deep samples alone";
            return HalfSpace{Vec3::UnitY(), tip};
        });
        EXPECT_LT(oracle_depth(garment, x, boundary), 1e-3) << face;
        EXPECT_GT(height_over(garment, x, centre), tip - 1e-3) << face;
        EXPECT_LT(measure_stretch(garment, x).max, 1.25) << face;
        const Points unknown =
            resolved([](const SurfaceSamples&, int) { return std::optional<HalfSpace>(); });
        EXPECT_TRUE(unknown == resolved(nullptr)) << face;
    }
    EXPECT_GT(pierced, 2) << "else this tests nothing";
}

TEST(ContactProjection, SettingsOutOfRangeAreRefused) {
    ContactProjectionSettings settings;
    settings.allowed_depth = -1e-3;
    EXPECT_THROW(ContactProjection(sheet(), settings), ArgumentError);
    settings = {};
    settings.sweeps = 0;
    EXPECT_THROW(ContactProjection(sheet(), settings), ArgumentError);
}

}  // namespace
}  // namespace cloth::contact_projection_test
