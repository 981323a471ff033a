// Queries that pass over limbs, and how much lies over skin inside other limbs.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "collision/proximity/brute_force.h"
#include "collision/proximity/proximity.h"
#include "data/core/errors.h"
#include "tests/test_meshes.h"

namespace cloth::limbs_test {
namespace {

using namespace test;

/// A limb for each slice of the mesh along x.
Obstacle sliced(const TriMesh& mesh, int limbs) {
    Obstacle obstacle = mesh_obstacle(mesh);
    auto labels = std::make_shared<std::vector<std::uint8_t>>();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const double x = mesh.vertices(mesh.faces(f, 0), 0);
        labels->push_back(
            static_cast<std::uint8_t>(std::clamp(int((x + 1.3) / 2.6 * limbs), 0, limbs - 1)));
    }
    obstacle.limbs = labels;
    return obstacle;
}

std::vector<int> numbers_up_to(int count) {
    std::vector<int> numbers(static_cast<size_t>(count));
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

TriMesh without(const TriMesh& mesh, const std::vector<std::uint8_t>& limbs, LimbSet ignored) {
    TriMesh rest{mesh.vertices, Faces(mesh.faces.rows(), 3)};
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        if (((ignored >> limbs[static_cast<size_t>(f)]) & 1u) == 0)
            rest.faces.row(count++) = mesh.faces.row(f);
    rest.faces = Faces(rest.faces.topRows(count));
    return rest;
}

/// Whether the corners that span a point are those of an ignored face, too.
bool is_on_border(const TriMesh& rest, const TriMesh& mesh, const std::vector<std::uint8_t>& limbs,
                  LimbSet ignored, const SurfacePoint& at) {
    const auto has_corner = [&](Eigen::Index face, const Vec3& corner) {
        for (int k = 0; k < 3; ++k)
            if (mesh.vertices.row(mesh.faces(face, k)).transpose() == corner) return true;
        return false;
    };
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        if (((ignored >> limbs[static_cast<size_t>(f)]) & 1u) == 0) continue;
        bool all = true;
        for (int k = 0; k < 3; ++k)
            if (at.barycentric[k] != 0.0)
                all = all && has_corner(f, rest.vertices.row(rest.faces(at.face, k)));
        if (all) return true;
    }
    return false;
}

TEST(Limbs, QueriesPassOverThoseThatAreIgnored) {
    std::mt19937 random(3);
    int at_border = 0, found = 0;
    for (const TriMesh& mesh :
         {roughened(icosphere(2), 0.3, 2), torus(40, 20, 0.8, 0.3), triangle_soup(icosphere(2))}) {
        const Obstacle obstacle = sliced(mesh, 5);
        const Boundary boundary = boundary_of({obstacle});
        const Points x = random_points(random, 400, 1.3);
        std::vector<LimbSet> ignored;
        std::vector<int> rows;
        for (int i = 0; i < x.rows(); ++i) ignored.push_back(random() % 32), rows.push_back(i);
        Proximity proximity({0.4, 0});
        SurfaceContacts all, contacts;
        proximity.query(x, boundary, all);
        contacts = all;
        proximity.query_rows(x, rows, boundary, contacts, StepEnd::start, {&ignored});
        for (int i = 0; i < x.rows(); ++i) {
            const LimbSet passed_over = ignored[static_cast<size_t>(i)];
            const TriMesh rest = without(mesh, *obstacle.limbs, passed_over);
            const auto expected = brute_force_closest(rest, x.row(i));
            if (!expected || expected->distance > 0.4) {
                EXPECT_FALSE(contacts.has(i));
                continue;
            }
            if (!contacts.has(i)) {
                EXPECT_TRUE(is_on_border(rest, mesh, *obstacle.limbs, passed_over, *expected));
                ++at_border;
                continue;
            }
            ++found;
            EXPECT_NEAR(std::abs(contacts.distance[i]), expected->distance, 1e-12);
            const auto limb = (*obstacle.limbs)[size_t(contacts.face[size_t(i)])];
            EXPECT_EQ((passed_over >> limb) & 1u, 0u);
        }
    }
    EXPECT_GT(found, 300);
    EXPECT_GT(at_border, 10);
}

TEST(Limbs, QueriesLookNoFartherThanTheyAreTold) {
    std::mt19937 random(11);
    const Boundary boundary = boundary_of({mesh_obstacle(torus(40, 20, 0.8, 0.3)),
                                           primitive(ObstacleShape::sphere, Vec3::Zero(), 0.1)});
    const Points x = random_points(random, 2000, 1.3);
    const std::vector<int> rows = numbers_up_to(2000);
    Proximity proximity({0.2, 0});
    SurfaceContacts all, near;
    proximity.query(x, boundary, all);
    near = all;
    VectorX radii(2000);
    for (const int i : rows) radii[i] = uniform(random, 0.0, 0.1);
    for (const bool each : {false, true}) {
        const QueryLimits limits{nullptr, 0.05, each ? &radii : nullptr};
        proximity.query_rows(x, rows, boundary, near, StepEnd::start, limits);
        int kept = 0, left_out = 0;
        for (const int i : rows) {
            const bool is_sphere = all.has(i) && all.obstacle[size_t(i)] == 1;
            const double distance = is_sphere ? all.distance[i] : std::abs(all.distance[i]);
            const double radius = each ? std::min(radii[i], 0.05) : 0.05;
            ASSERT_EQ(near.has(i), distance <= radius) << i;
            ++(near.has(i) ? kept : left_out);
            if (near.has(i)) {
                EXPECT_EQ(near.distance[i], all.distance[i]);
            } else {
                EXPECT_LE(near.clearance[i], radius);
            }
        }
        EXPECT_GT(std::min(kept, left_out), 50);
    }
    proximity.query_rows(x, rows, boundary, near, StepEnd::start, {nullptr, 1.0});
    EXPECT_EQ(near.distance, all.distance) << "not beyond the settings' radius";
}

TEST(Limbs, QueriesStoreNoContactsFartherThanTheyAreTold) {
    std::mt19937 random(17);
    const Boundary boundary = boundary_of({mesh_obstacle(torus(40, 20, 0.8, 0.3)),
                                           primitive(ObstacleShape::sphere, Vec3::Zero(), 0.3)});
    const Points x = random_points(random, 1000, 1.1);
    const std::vector<int> rows = numbers_up_to(1000);
    SurfaceContacts all, stored;
    Proximity({0.4, 0}).query(x, boundary, all);
    for (const auto& [within, all_rows] : {std::pair(-0.05, false), std::pair(0.0, false),
                                           std::pair(0.1, false), std::pair(0.0, true)}) {
        QueryLimits limits;
        limits.store_within = within;
        stored = all;
        if (all_rows)
            Proximity({0.4, 0}).query(x, boundary, stored, StepEnd::start, limits);
        else
            Proximity({0.4, 0}).query_rows(x, rows, boundary, stored, StepEnd::start, limits);
        EXPECT_EQ(stored.clearance, all.clearance);
        int kept = 0;
        for (const int i : rows) {
            ASSERT_EQ(stored.has(i), all.has(i) && all.distance[i] <= within) << i;
            if (!stored.has(i)) continue;
            ++kept;
            EXPECT_EQ(stored.distance[i], all.distance[i]);
            EXPECT_EQ(stored.point0.row(i), all.point0.row(i));
            EXPECT_EQ(stored.normal1.row(i), all.normal1.row(i));
        }
        EXPECT_GT(kept, 50);
        EXPECT_LT(kept, 900);
    }
}

TEST(Limbs, WhatWasAskedBeforeChangesNoAnswer) {
    std::mt19937 random(5);
    int found = 0;
    for (const TriMesh& mesh : {roughened(icosphere(2), 0.3, 2), triangle_soup(icosphere(2))}) {
        const Boundary boundary = boundary_of({sliced(mesh, 5)});
        Points x = random_points(random, 500, 1.3);
        for (int i = 0; i < 100; ++i) x.row(i) = 1.1 * mesh.vertices.row(i);  // nearest to vertices
        const std::vector<int> rows = numbers_up_to(500);
        Proximity asked({0.6, 0});
        SurfaceContacts all, contacts;
        asked.query(x, boundary, all);
        std::vector<LimbSet> ignored(500, 0);
        for (int round = 0; round < 8; ++round) {
            for (LimbSet& limbs : ignored) limbs = round % 3 == 2 ? 0 : limbs | 1u << random() % 5;
            const double radius = round % 2 == 0 ? 0.6 : 0.3;
            VectorX radii(500);
            for (const int i : rows) radii[i] = uniform(random, 0.0, round % 4 == 0 ? 1.0 : 0.3);
            const QueryLimits limits{&ignored, radius, round % 4 < 2 ? &radii : nullptr};
            contacts = all;
            asked.query_rows(x, rows, boundary, contacts, StepEnd::start, limits);
            Proximity fresh({0.6, 0});
            SurfaceContacts expected = all;
            fresh.query_rows(x, rows, boundary, expected, StepEnd::start, limits);
            EXPECT_EQ(contacts.face, expected.face) << "round " << round;
            EXPECT_EQ(contacts.distance, expected.distance) << "round " << round;
            EXPECT_EQ(contacts.barycentric, expected.barycentric) << "round " << round;
            for (const int face : contacts.face) found += face >= 0;
        }
    }
    EXPECT_GT(found, 1000);
}

TEST(Limbs, TheBoundarySaysWhatVerticesIgnore) {
    const TriMesh mesh = icosphere(2);
    Boundary boundary = boundary_of({sliced(mesh, 2)});
    Points x(2, 3);
    x << -1.05, 0, 0, 1.05, 0, 0;
    Proximity proximity({0.4, 0});
    SurfaceContacts contacts;
    boundary.ignored_limbs = {1, 1};  // limb 0, the half x < 0
    proximity.query(x, boundary, contacts);
    EXPECT_FALSE(contacts.has(0));
    EXPECT_TRUE(contacts.has(1));
    VectorX distance;
    proximity.signed_distance(x, boundary, StepEnd::end, distance);
    EXPECT_TRUE(std::isinf(distance[0]));
    boundary.ignored_limbs = {1};  // of another garment
    proximity.query(x, boundary, contacts);
    EXPECT_TRUE(contacts.has(0) && contacts.has(1));
}

/// Two balls of radius 0.2, limbs 0 and 1 of one mesh, 0.3 apart along x; points around the first.
struct TwoBalls {
    const double radius = 0.2;
    const Vec3 centre{0.3, 0, 0};  ///< of the second
    const TriMesh ball = icosphere(4);
    Boundary boundary;
    Points x{500, 3};

    TwoBalls() {
        const Eigen::Index count = ball.vertices.rows();
        TriMesh both{Points(2 * count, 3), Faces(2 * ball.faces.rows(), 3)};
        both.vertices.topRows(count) = radius * ball.vertices;
        both.vertices.bottomRows(count) = (radius * ball.vertices).rowwise() + centre.transpose();
        both.faces << ball.faces, ball.faces.array() + static_cast<int>(count);
        std::mt19937 random(7);
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            x.row(i) = 1.001 * radius * random_point(random, 1.0).normalized().transpose();
        Obstacle obstacle = mesh_obstacle(both);
        auto limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(both.faces.rows()), 1);
        std::fill_n(limbs->begin(), ball.faces.rows(), 0);
        obstacle.limbs = limbs;
        boundary = boundary_of({obstacle});
    }
};

TEST(Limbs, WhatCoversSeveralRowsIsWhatCoversEachForAnyNumberOfThreads) {
    const TwoBalls balls;
    std::vector<int> rows;
    std::vector<LimbSet> ignored(size_t(balls.x.rows()), 0);
    for (int i = 0; i < balls.x.rows(); ++i) {
        if (i % 3 != 0) rows.push_back(i);
        if (i % 5 == 0) ignored[size_t(i)] = 2;
    }
    for (const int threads : {1, 2, 5}) {
        Proximity proximity({2.0, threads});
        SurfaceContacts contacts;
        proximity.query(balls.x, balls.boundary, contacts);
        std::vector<std::optional<Cover>> covers;
        proximity.cover_rows(balls.boundary, contacts, rows, StepEnd::start, ignored, covers);
        ASSERT_EQ(covers.size(), rows.size());
        int found = 0;
        for (size_t k = 0; k < rows.size(); ++k) {
            const auto each =
                proximity.cover(contacts, rows[k], StepEnd::start, ignored[size_t(rows[k])]);
            ASSERT_EQ(covers[k].has_value(), each.has_value()) << "point " << rows[k];
            if (!each) continue;
            ++found;
            EXPECT_EQ(covers[k]->face, each->face) << "point " << rows[k];
            EXPECT_EQ(covers[k]->depth, each->depth) << "point " << rows[k];
        }
        EXPECT_GT(found, 10);
    }
}

TEST(Limbs, CoverCanBeLookedAtWhereThePointsAreCarriedTo) {
    const TwoBalls balls;
    Boundary moving = balls.boundary;
    Obstacle& body = moving.obstacles[0];
    for (Eigen::Index i = body.x1.rows() / 2; i < body.x1.rows(); ++i)
        body.x1.row(i) += Eigen::RowVector3d(0.05, -0.1, 0.02);
    Boundary there = moving;
    there.obstacles[0].x0 = body.x1;
    const std::vector<int> rows = numbers_up_to(int(balls.x.rows()));
    const std::vector<LimbSet> ignored(rows.size(), 0);
    Proximity proximity, other;
    SurfaceContacts contacts, carried;
    proximity.query(balls.x, moving, contacts);
    carried = contacts;
    carried.point0 = contacts.point1;
    std::vector<std::optional<Cover>> before, after, expected;
    proximity.cover_rows(moving, contacts, rows, StepEnd::start, ignored, before);
    proximity.cover_rows(moving, contacts, rows, StepEnd::end, ignored, after);
    other.cover_rows(there, carried, rows, StepEnd::start, ignored, expected);
    int changed = 0;
    for (size_t k = 0; k < rows.size(); ++k) {
        ASSERT_EQ(after[k].has_value(), expected[k].has_value()) << "point " << k;
        changed += before[k].has_value() != after[k].has_value();
        if (after[k]) {
            EXPECT_EQ(after[k]->depth, expected[k]->depth);
        }
    }
    EXPECT_GT(changed, 3);
}

TEST(Limbs, CoverIsWhatLiesOverAPoint) {
    const TwoBalls balls;
    const double radius = balls.radius;
    const Vec3& centre = balls.centre;
    const TriMesh& ball = balls.ball;
    const Points& x = balls.x;
    Proximity proximity;
    SurfaceContacts contacts;
    proximity.query(x, balls.boundary, contacts);
    int covered = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const auto cover = proximity.cover(contacts, i, StepEnd::start);
        const Vec3 from = x.row(i) / 1.001, up = from / radius;
        const double away = (from - centre).norm();
        if (away > 0.205) {
            EXPECT_FALSE(cover);
        }
        if (away > 0.195 || contacts.face[size_t(i)] >= ball.faces.rows()) continue;
        ++covered;
        ASSERT_TRUE(cover);
        EXPECT_GE(cover->face, ball.faces.rows()) << "the other ball";
        EXPECT_FALSE(proximity.cover(contacts, i, StepEnd::start, /*ignored=*/2));
        const double along = (centre - from).dot(up);
        const double exit = along + std::sqrt(along * along + radius * radius - away * away);
        EXPECT_NEAR(cover->depth, exit, 0.01) << "point " << i;
    }
    EXPECT_GT(covered, 20);
}

TEST(Limbs, UnusableOnesAreNamedBySetUpAndDoNoHarm) {
    Obstacle obstacle = mesh_obstacle(icosphere(1));
    const auto message = [](const Obstacle& wrong) -> std::string {
        try {
            check_obstacles(boundary_of({wrong}));
            return "";
        } catch (const ArgumentError& error) {
            return error.what();
        }
    };
    obstacle.limbs = std::make_shared<std::vector<std::uint8_t>>(3, 0);
    EXPECT_NE(message(obstacle).find("one limb from 0 to 31 for each face"), std::string::npos);
    Obstacle far = obstacle;
    far.limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(far.faces->rows()), 32);
    EXPECT_NE(message(far).find("from 0 to 31"), std::string::npos);
    Points x(1, 3);
    x << 0, 1.1, 0;
    Proximity proximity({0.4, 0});
    SurfaceContacts contacts;
    for (const Obstacle& wrong : {obstacle, far}) {
        proximity.query(x, boundary_of({wrong}), contacts);
        EXPECT_TRUE(contacts.has(0));
    }
}

}  // namespace
}  // namespace cloth::limbs_test
