// What Proximity remembers between queries must never show in its results.

#include <gtest/gtest.h>

#include <numeric>

#include "collision/proximity/proximity.h"
#include "tests/collision/proximity/same_bits.h"
#include "tests/test_meshes.h"

namespace cloth::proximity_cache_test {
namespace {

using namespace test;

/// A rough ball that turns and swells; many points are closest to an edge or a vertex.
Boundary frame(const Obstacle& rest, int index) {
    Obstacle obstacle = rest;
    const auto at = [&](int i) {
        const double swell = 1 + 0.2 * std::sin(0.3 * i);
        return Points(transformed(rest.x0, pose_of({0.05 * i, 0, 0}, 0.1 * i)) * swell);
    };
    obstacle.x0 = at(index);
    obstacle.x1 = at(index + 1);
    return boundary_of({obstacle});
}

TEST(ProximityCache, HistoryDoesNotShow) {
    std::mt19937 random(1);
    const Obstacle rest = mesh_obstacle(roughened(icosphere(3), 0.1, 1));
    const Points x = random_points(random, 1000, 1.4);
    Proximity warm({0.4, 0});
    for (int i = 0; i < 12; ++i) {
        SurfaceContacts by_warm, by_fresh;
        Proximity fresh({0.4, 0});
        warm.query(x, frame(rest, i), by_warm);
        fresh.query(x, frame(rest, i), by_fresh);
        expect_same_bits(by_warm, by_fresh);
    }
}

/// As steps ask: at the end of each, for points of which some have moved, and at the start of the
/// next one, for the same points and the same surface. Limbs and radii change in between.
TEST(ProximityCache, AnswersThatAreKnownAlreadyAreThoseOfANewSearch) {
    std::mt19937 random(6);
    Obstacle rest = mesh_obstacle(roughened(icosphere(3), 0.1, 1));
    auto limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(rest.faces->rows()));
    for (size_t f = 0; f < limbs->size(); ++f) (*limbs)[f] = f % 2;
    rest.limbs = limbs;
    Points x = random_points(random, 300, 1.3);
    const std::vector<int> some = {5, 7, 200};
    const LimbSet ignored[] = {0, 1, 1, 0, 2, 2, 0};
    Proximity warm({0.4, 0});
    SurfaceContacts by_warm;
    const auto expect_as_new = [&](const Boundary& boundary, StepEnd end, double radius) {
        SurfaceContacts by_fresh;
        Proximity({radius, 0}).query(x, boundary, by_fresh, end);
        expect_same_bits(by_warm, by_fresh);
    };
    for (int i = 0; i < 7; ++i) {
        Boundary boundary = frame(rest, i);
        boundary.ignored_limbs.assign(300, ignored[i]);
        warm.query(x, boundary, by_warm);
        expect_as_new(boundary, StepEnd::start, 0.4);
        for (int row = i; row < 300; row += 2 + i)
            x.row(row) += random_point(random, 0.1).transpose();
        warm.query(x, boundary, by_warm, StepEnd::end);
        expect_as_new(boundary, StepEnd::end, 0.4);
        std::vector<int> all(300);
        std::iota(all.begin(), all.end(), 0);
        const double radius = i % 2 == 0 ? 0.1 : 0.4;
        warm.query_rows(x, all, boundary, by_warm, StepEnd::end, {nullptr, radius});
        expect_as_new(boundary, StepEnd::end, radius);
        for (const int row : some) x.row(row) += random_point(random, 0.1).transpose();
        warm.query_rows(x, some, boundary, by_warm, StepEnd::end);
    }
}

TEST(ProximityCache, ThreadsDoNotShow) {
    std::mt19937 random(2);
    const Obstacle rest = mesh_obstacle(roughened(icosphere(3), 0.1, 1));
    const Points x = random_points(random, 3000, 1.4);
    SurfaceContacts reference, contacts;
    for (const int threads : {1, 2, 4, 7}) {
        Proximity proximity({0.4, threads});
        for (int i = 0; i < 3; ++i) proximity.query(x, frame(rest, i), contacts);
        if (threads == 1) reference = contacts;
        expect_same_bits(contacts, reference);
    }
}

/// Coincident points of a symmetric mesh tie to the bit; the answer is still one.
TEST(ProximityCache, TiesDoNotDependOnTheHint) {
    const Boundary boundary = boundary_of({mesh_obstacle(cube())});
    Points centre = Points::Zero(1, 3);
    Proximity warm({2.0, 0}), fresh({2.0, 0});
    SurfaceContacts contacts, expected;
    fresh.query(centre, boundary, expected);
    for (const Vec3& first : {Vec3(0, 0, 0.9), Vec3(0.9, 0, 0), Vec3(0, -0.9, 0)}) {
        warm.query(first.transpose(), boundary, contacts);
        warm.query(centre, boundary, contacts);
        expect_same_bits(contacts, expected);
    }
}

TEST(ProximityCache, NothingIsBuiltWithoutMeshes) {
    std::mt19937 random(3);
    Proximity proximity;
    SurfaceContacts contacts;
    const Points x = random_points(random, 10, 1.0);
    proximity.query(x, Boundary(), contacts);
    EXPECT_EQ(contacts.obstacle, std::vector<int>(10, -1));
    EXPECT_TRUE((contacts.distance.array() == std::numeric_limits<double>::infinity()).all());
    proximity.query(x, boundary_of({primitive(ObstacleShape::plane, Vec3::Zero(), 0)}), contacts);
    EXPECT_EQ(proximity.cached_meshes(), 0);
}

TEST(ProximityCache, MeshesAreForgottenWhenNotSeen) {
    Proximity proximity;
    SurfaceContacts contacts;
    const Points x = Points::Zero(1, 3);
    std::weak_ptr<const Faces> faces;
    {
        const Obstacle obstacle = mesh_obstacle(cube());
        faces = obstacle.faces;
        proximity.query(x, boundary_of({obstacle}), contacts);
    }
    EXPECT_EQ(proximity.cached_meshes(), 1);
    EXPECT_FALSE(faces.expired());  // the key cannot be recycled while it is in use
    for (int i = 0; i < 100; ++i) proximity.query(x, Boundary(), contacts);
    EXPECT_EQ(proximity.cached_meshes(), 0);
    EXPECT_TRUE(faces.expired());
}

/// Two characters may share their faces, with vertices of their own.
TEST(ProximityCache, OneMeshMayStandInABoundaryTwice) {
    Obstacle first = mesh_obstacle(cube()), second = first;
    second.x0 = second.x1 = transformed(first.x0, pose_of({5, 0, 0}));
    Points x(2, 3);
    x << 1.1, 0, 0, 6.1, 0, 0;
    Proximity proximity({0.5, 0});
    SurfaceContacts contacts;
    for (int repeat = 0; repeat < 3; ++repeat) {
        proximity.query(x, boundary_of({first, second}), contacts);
        EXPECT_EQ(contacts.obstacle, (std::vector<int>{0, 1}));
        EXPECT_NEAR(contacts.distance[0], 0.1, 1e-12);
        EXPECT_NEAR(contacts.distance[1], 0.1, 1e-12);
        EXPECT_EQ(proximity.cached_meshes(), 2);
    }
}

TEST(ProximityCache, SetsOfPointsMayAlternate) {
    std::mt19937 random(4);
    const Obstacle rest = mesh_obstacle(roughened(icosphere(2), 0.1, 1));
    Proximity warm({0.4, 0});
    for (int i = 0; i < 12; ++i) {
        const Points x = random_points(random, 10 + 10 * (i % 6), 1.3);
        SurfaceContacts by_warm, by_fresh;
        Proximity fresh({0.4, 0});
        warm.query(x, frame(rest, i), by_warm);
        fresh.query(x, frame(rest, i), by_fresh);
        expect_same_bits(by_warm, by_fresh);
    }
}

}  // namespace
}  // namespace cloth::proximity_cache_test
