#include "collision/ccd/tunnelling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "collision/ccd/primitive_sweep.h"
#include "collision/proximity/brute_force.h"
#include "collision/response/neighbour_pull.h"
#include "data/authoring/sheet.h"
#include "tests/collision/random_primitives.h"

namespace cloth::tunnelling_test {
namespace {

using namespace test;

/// A sheet of a metre in the plane y = 0.
Garment sheet(const std::vector<int>& pins = {}) {
    return Garment("sheet", make_sheet(1.0, 1.0, 400), Fabric::soft_cotton(), pins);
}

Points shifted(const Points& x, const Vec3& by) {
    return x.rowwise() + by.transpose();
}

/// The mesh, scaled in each coordinate.
TriMesh scaled(TriMesh mesh, const Vec3& size) {
    for (int k = 0; k < 3; ++k) mesh.vertices.col(k) *= size[k];
    return mesh;
}

Obstacle moving(const TriMesh& mesh, const Pose& from, const Pose& to) {
    Obstacle obstacle = mesh_obstacle(mesh);
    obstacle.x0 = transformed(mesh.vertices, from);
    obstacle.x1 = transformed(mesh.vertices, to);
    return obstacle;
}

Obstacle moving(Obstacle shape, const Pose& from, const Pose& to) {
    shape.pose0 = from;
    shape.pose1 = to;
    return shape;
}

/// A plate of 2 cm, as a mesh and as a box.
std::vector<Obstacle> plates(const Pose& from, const Pose& to) {
    const Vec3 size(0.3, 0.01, 0.3);
    return {moving(scaled(cube(), size), from, to),
            moving(primitive(ObstacleShape::box, size, 0.0), from, to)};
}

std::set<int> vertices_of(const std::vector<Tunnelling>& found, Eigen::Index count) {
    std::set<int> points;
    for (const Tunnelling& solid : found)
        if (solid.point < count) points.insert(solid.point);
    return points;
}

/// The deepest that a point is inside the obstacle on its way, from 400 samples (m), and, if it is
/// outside at either end, whether it goes in and comes out on sides that face away from each other.
struct SampledWay {
    double depth = 0.0;
    bool through = false;
};

SampledWay sample_way(const Obstacle& mesh, const Vec3& p0, const Vec3& p1) {
    constexpr int samples = 400;
    SampledWay way;
    const Vec3 low = mesh.x0.colwise().minCoeff().cwiseMin(mesh.x1.colwise().minCoeff());
    const Vec3 high = mesh.x0.colwise().maxCoeff().cwiseMax(mesh.x1.colwise().maxCoeff());
    if ((p0.cwiseMax(p1).array() < low.array()).any() ||
        (p0.cwiseMin(p1).array() > high.array()).any())
        return way;  // far from all the way of the mesh
    Vec3 in = Vec3::Zero(), out = Vec3::Zero();
    bool inside = false, known = false;
    for (int k = 0; k <= samples; ++k) {
        const double t = double(k) / samples;
        TriMesh now{(1 - t) * mesh.x0 + t * mesh.x1, *mesh.faces};
        const Vec3 p = (1 - t) * p0 + t * p1;
        const double distance = brute_force_signed_distance(now, p);
        way.depth = std::max(way.depth, -distance);
        if ((distance < 0) == inside) continue;
        inside = !inside;
        const auto corner = now.faces.row(brute_force_closest(now, p)->face);
        const Vec3 a = mesh.x1.row(corner[0]), b = mesh.x1.row(corner[1]),
                   c = mesh.x1.row(corner[2]);
        const Vec3 normal = (b - a).cross(c - a).normalized();
        if (inside && !known) in = normal, known = true;
        if (!inside) out = normal;
    }
    way.through = known && !inside && in.dot(out) < 0.0;
    return way;
}

TEST(Tunnelling, AreThoseThatSamplesOfTheWayShow) {
    const Garment garment = sheet();
    const Points& x0 = garment.rest().vertices;
    const Points x1 = shifted(x0, {0.02, 0.01, 0.0});
    // an egg that turns while it passes through the sheet from below
    const TriMesh egg = scaled(icosphere(2), {0.2, 0.08, 0.12});
    const Boundary boundary = boundary_of(
        {moving(egg, pose_of({0.1, -0.11, 0.0}, 0.0), pose_of({0.15, 0.13, 0.05}, 0.3))});
    TunnellingDetector detector(garment);
    const std::set<int> found =
        vertices_of(detector.find(boundary, x0, x1, 0), garment.vertex_count());
    int through = 0, beside = 0;
    for (int i = 0; i < garment.vertex_count(); ++i) {
        const SampledWay way = sample_way(boundary.obstacles[0], x0.row(i), x1.row(i));
        if (way.depth > 0.0 && way.depth < 5e-3) continue;  // the samples may miss its normals
        EXPECT_EQ(found.count(i) > 0, way.through) << "vertex " << i;
        ++(way.through ? through : beside);
    }
    EXPECT_GT(through, 15);
    EXPECT_GT(beside, 200);
}

TEST(Tunnelling, TellHowThickTheSolidIs) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const TriMesh plate = scaled(cube(), {0.3, 0.01, 0.3});
    const Boundary mesh =
        boundary_of({moving(plate, pose_of({0, -0.03, 0}), pose_of({0, 0.04, 0}))});
    Obstacle box = primitive(ObstacleShape::box, {0.3, 0.01, 0.3}, 0.0);
    const Boundary shape =
        boundary_of({moving(box, pose_of({0, -0.03, 0}), pose_of({0, 0.04, 0}))});
    TunnellingDetector detector(garment);
    EXPECT_FALSE(detector.thinnest());
    const auto expect_plate = [&](const Boundary& boundary) {
        const auto& found = detector.find(boundary, x, x, 0);
        EXPECT_NEAR(detector.thinnest().value(), 0.02, 1e-5);
        for (const Tunnelling& solid : found) EXPECT_NEAR(solid.thickness, 0.02, 1e-5);
        return vertices_of(found, x.rows());
    };
    const std::set<int> through = expect_plate(mesh);
    EXPECT_EQ(through, expect_plate(shape));
    EXPECT_GT(through.size(), 100u);
    for (int i = 0; i < x.rows(); ++i)
        EXPECT_EQ(through.count(i) > 0, std::abs(x(i, 0)) < 0.3 && std::abs(x(i, 2)) < 0.3);
}

TEST(Tunnelling, OfPrimitivesAreThoseOfTheirMeshes) {
    const Garment garment = sheet();
    const Points& x0 = garment.rest().vertices;
    const Points x1 = shifted(x0, {-0.01, -0.02, 0.03});
    const Pose from = pose_of({0.02, -0.25, 0.01}), to = pose_of({0.06, 0.27, 0.03});
    TunnellingDetector detector(garment);
    const auto found = [&](const Obstacle& obstacle) {
        detector.find(boundary_of({obstacle}), x0, x1, 0);
        return vertices_of(detector.found(), x0.rows());
    };
    const std::set<int> ball =
        found(moving(primitive(ObstacleShape::sphere, Vec3::Zero(), 0.2), from, to));
    const std::set<int> mesh = found(moving(scaled(icosphere(4), Vec3::Constant(0.2)), from, to));
    EXPECT_GT(ball.size(), 20u);
    std::vector<int> different;
    std::set_symmetric_difference(ball.begin(), ball.end(), mesh.begin(), mesh.end(),
                                  std::back_inserter(different));
    for (const int i : different)  // only at the rim
        EXPECT_NEAR((x0.row(i) - Eigen::RowVector3d(0.05, 0.0, 0.0)).norm(), 0.2, 0.03);
}

/// Whether a straight path goes through a primitive, with nothing passed over.
bool goes_through(const Obstacle& shape, const Vec3& from, const Vec3& to) {
    constexpr double shallow = 5e-3, thin = 5e-3;  // m, as documented
    const Vec3 p0 = shape.pose0.inverse() * from, p1 = shape.pose1.inverse() * to;
    const PrimitivePath path = follow_path(shape, p0, p1);
    if (!path.meets || path.in.distance < -shallow) return false;
    if (path.out.distance < -shallow) return (path.in.point - p1).norm() >= thin;
    return path.in.normal.dot(path.out.normal) < 0.0 &&
           (path.in.point - path.out.point).norm() >= thin;
}

TEST(Tunnelling, OfManyPrimitivesAreThoseOfEveryPathLookedAt) {
    std::mt19937 random(13);
    const Garment garment = sheet({0, 7});
    const SurfaceSamples samples(garment);
    const Points& x0 = garment.rest().vertices;
    TunnellingDetector detector(garment);
    size_t count = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const Boundary boundary = random_primitives(random, trial / 2);
        Points x1 = shifted(x0, random_point(random, 0.1));
        for (Eigen::Index i = 0; i < x1.rows(); ++i)
            x1.row(i) += random_point(random, i % 50 == 0 ? 0.3 : 0.02);
        std::set<std::pair<int, int>> found, expected;
        for (const Tunnelling& solid : detector.find(boundary, x0, x1, 0))
            found.insert({solid.obstacle, solid.point});
        for (int k = 0; k < static_cast<int>(boundary.obstacles.size()); ++k) {
            const Obstacle& shape = boundary.obstacles[static_cast<size_t>(k)];
            for (int i = 0; i < garment.vertex_count(); ++i)
                if (!garment.is_pinned()[static_cast<size_t>(i)] &&
                    goes_through(shape, x0.row(i), x1.row(i)))
                    expected.insert({k, i});
            for (int sample = 0; sample < samples.count(); ++sample) {
                const SurfaceSamples::Corners at = samples.corners(sample);
                if (samples.is_movable(sample) &&
                    goes_through(shape, at.position(x0), at.position(x1)))
                    expected.insert({k, garment.vertex_count() + sample});
            }
        }
        EXPECT_EQ(found, expected);
        count += found.size();
    }
    EXPECT_GT(count, 3000u);
}

TEST(Tunnelling, OfSmallPrimitivesAreSeenBetweenVertices) {
    const Garment garment = sheet();  // vertices about 5 cm apart
    const Points& x = garment.rest().vertices;
    const auto corner = garment.rest().faces.row(garment.face_count() / 2);
    const Vec3 centre = (x.row(corner[0]) + x.row(corner[1]) + x.row(corner[2])) / 3.0;
    const Vec3 down(0, -0.03, 0);
    const Obstacle pea = moving(primitive(ObstacleShape::sphere, Vec3::Zero(), 0.006),
                                pose_of(centre + down), pose_of(centre - down));
    TunnellingDetector detector(garment);
    const auto& found = detector.find(boundary_of({pea}), x, x, 0);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].point, garment.vertex_count() + garment.face_count() / 2);
    EXPECT_NEAR(found[0].thickness, 0.012, 1e-5);
}

TEST(Tunnelling, AreHeldOnTheSideThatTheyCameFrom) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const Pose from = pose_of({0, -0.03, 0}), to = pose_of({0, 0.04, 0}, 0.1);
    for (const Obstacle& plate : plates(from, to)) {
        const Boundary boundary = boundary_of({plate});
        TunnellingDetector detector(garment);
        const std::set<int> through = vertices_of(detector.find(boundary, x, x, 0), x.rows());
        ASSERT_GT(through.size(), 100u);
        SurfaceContacts contacts;
        Proximity().query(x, boundary, contacts, StepEnd::end);
        const SurfaceContacts nearest = contacts;
        Points held = x;
        detector.hold_where_they_went_in(contacts, held);
        for (int i = 0; i < x.rows(); ++i) {
            if (through.count(i) == 0) {
                EXPECT_EQ(contacts.point1.row(i), nearest.point1.row(i));
                continue;
            }
            if (x.row(i).cwiseAbs().maxCoeff() > 0.28) continue;  // near its sides
            // the plate's upper side at both ends: it came from below
            const Vec3 top0 = from.inverse() * Vec3(contacts.point0.row(i));
            const Vec3 top1 = to.inverse() * Vec3(contacts.point1.row(i));
            EXPECT_NEAR(top0.y(), 0.01, 1e-9);
            EXPECT_LT((top0 - top1).norm(), 1e-9) << "the same point of it";
            EXPECT_NEAR(contacts.normal0(i, 1), 1.0, 1e-9);
            EXPECT_GT(to.linear().col(1).dot(contacts.normal1.row(i)), 1.0 - 1e-9);
            EXPECT_GT((to.inverse() * Vec3(held.row(i))).y(), 0.01 - 1e-9);
        }
        detector.find(boundary, x, held, 0);
        EXPECT_TRUE(vertices_of(detector.found(), x.rows()).empty());
    }
}

TEST(Tunnelling, AreTakenBackToWhereTheyWentIn) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const Pose from = pose_of({0, -0.03, 0}), to = pose_of({0, 0.04, 0}, 0.1);
    for (const Obstacle& plate : plates(from, to)) {
        const Boundary boundary = boundary_of({plate});
        TunnellingDetector detector(garment);
        const std::vector<Tunnelling> found = detector.find(boundary, x, x, 0);
        ASSERT_GT(vertices_of(found, x.rows()).size(), 100u);
        Points back = x;
        const double depth = detector.take_back(boundary, x, 5e-4, 0, back);
        const auto is_amid = [&](int i) { return x.row(i).cwiseAbs().maxCoeff() < 0.22; };
        for (const int i : vertices_of(detector.found(), x.rows()))
            EXPECT_FALSE(is_amid(i)) << "vertex " << i << " is still through";
        TunnellingDetector other(garment);
        other.find(boundary, x, back, 0);
        EXPECT_EQ(other.found().size(), detector.found().size());
        VectorX distance;
        Proximity().signed_distance(back, boundary, StepEnd::end, distance);
        for (const Tunnelling& solid : found) {
            if (solid.point >= x.rows() || !is_amid(solid.point)) continue;
            EXPECT_GT(distance[solid.point], 4e-4);
            EXPECT_LT((to.inverse() * Vec3(back.row(solid.point))).y(), 0.0106);
        }
        double deepest = 0.0;
        for (const auto& edge : garment.edges()) {
            if (back.row(edge[0]) == x.row(edge[0]) && back.row(edge[1]) == x.row(edge[1]))
                continue;
            VectorX at_middle;
            Proximity().signed_distance(0.5 * (back.row(edge[0]) + back.row(edge[1])), boundary,
                                        StepEnd::end, at_middle);
            deepest = std::max(deepest, -at_middle[0]);
        }
        EXPECT_GT(deepest, 1e-3) << "the scene says nothing of edges";
        EXPECT_GE(depth, deepest - 1e-9);
    }
}

/// The middle goes back by 7 cm, onto the bar.
TEST(Tunnelling, AreTakenBackWithTheirNeighbours) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const auto longest = [&](const Points& at) {
        double stretch = 0.0;
        for (const auto& [a, b] : garment.edges())
            stretch =
                std::max(stretch, (at.row(a) - at.row(b)).norm() / (x.row(a) - x.row(b)).norm());
        return stretch;
    };
    Eigen::Index middle;
    x.rowwise().squaredNorm().minCoeff(&middle);
    const Vec3 size(0.02, 0.01, 0.02), beside(x(middle, 0), 0, x(middle, 2));
    const Pose from = pose_of(beside - Vec3(0, 0.015, 0)), to = pose_of(beside + Vec3(0, 0.06, 0));
    for (const Obstacle& bar : {moving(scaled(cube(), size), from, to),
                                moving(primitive(ObstacleShape::box, size, 0.0), from, to)}) {
        const Boundary boundary = boundary_of({bar});
        const auto taken_back = [&](NeighbourPull* pull) {
            TunnellingDetector detector(garment);
            EXPECT_EQ(vertices_of(detector.find(boundary, x, x, 0), x.rows()).count(int(middle)),
                      1u);
            Points back = x;
            detector.take_back(boundary, x, 5e-4, 0, back, pull);
            EXPECT_TRUE(detector.found().empty());
            EXPECT_NEAR(back(middle, 1), 0.0705, 1e-9);
            return back;
        };
        EXPECT_GT(longest(taken_back(nullptr)), 1.5) << "the scene says nothing of neighbours";
        NeighbourPull pull(garment, 1.2);
        const Points back = taken_back(&pull);
        EXPECT_LT(longest(back), 1.001 * 1.2 + 1e-9);
        VectorX distance;
        Proximity().signed_distance(back, boundary, StepEnd::end, distance);
        EXPECT_GT(distance.minCoeff(), 0.0);
    }
}

TEST(Tunnelling, BetweenVerticesAreHeldByContactsOfTheirOwn) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    Obstacle rod = primitive(ObstacleShape::capsule, {0, 0.6, 0}, 0.004);
    const Eigen::AngleAxisd along_x(0.5 * M_PI, Vec3::UnitZ());
    for (const bool end : {false, true})
        (end ? rod.pose1 : rod.pose0) =
            Pose(Eigen::Translation3d(0.0, end ? 0.03 : -0.03, 0.013) * along_x);
    const Boundary boundary = boundary_of({rod});
    TunnellingDetector detector(garment);
    const std::vector<Tunnelling> found = detector.find(boundary, x, x, 0);
    ASSERT_GT(found.size(), 10u);
    SurfaceContacts contacts;
    Proximity().query(x, boundary, contacts, StepEnd::end);
    Points held = x;
    detector.hold_where_they_went_in(contacts, held);
    ASSERT_GT(contacts.ridges.size(), 5u) << "faces and edges";
    for (const RidgeContact& ridge : contacts.ridges) {
        EXPECT_NEAR(ridge.weight[0] + ridge.weight[1] + ridge.weight[2], 1.0, 1e-12);
        Vec3 point = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
            point += ridge.weight[static_cast<size_t>(k)] *
                     held.row(garment.rest().faces(ridge.face, k)).transpose();
        EXPECT_GT(ridge.normal.y(), 0.5);
        EXPECT_GT(ridge.normal.dot(point) - ridge.height, -1e-9);
        EXPECT_NEAR(ridge.normal.dot(ridge.point1), ridge.height, 1e-12);
        EXPECT_LT((ridge.point1 - ridge.point0 - Vec3(0, 0.06, 0)).norm(), 1e-9);
    }
}

TEST(Tunnelling, AreNotWhatSlidesOrCutsACorner) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const TriMesh block = scaled(cube(), {0.2, 0.1, 0.2});
    const Obstacle box = primitive(ObstacleShape::box, {0.2, 0.1, 0.2}, 0.0);
    TunnellingDetector detector(garment);
    // the sheet slides 30 cm along the top: some of it ends well beyond the edge, below the top
    Points x1 = shifted(x, {0.3, -0.03, 0.0});
    for (Eigen::Index i = 0; i < x1.rows(); ++i)
        if (std::abs(x1(i, 0)) < 0.27 && std::abs(x1(i, 2)) < 0.27) x1(i, 1) = 0.0;
    const Pose below = pose_of({0, -0.101, 0});
    EXPECT_TRUE(detector.find(boundary_of({moving(block, below, below)}), x, x1, 0).empty());
    EXPECT_TRUE(detector.find(boundary_of({moving(box, below, below)}), x, x1, 0).empty());
    // a ball that turns on the spot, the cloth at rest on it
    const TriMesh ball = scaled(icosphere(3), Vec3::Constant(0.1));
    const Obstacle turning =
        moving(ball, pose_of({0, -0.1, 0}), pose_of({0, -0.1, 0}, 0.7, {0, 0, 1}));
    EXPECT_TRUE(detector.find(boundary_of({turning}), x, x, 0).empty());
}

TEST(Tunnelling, FastThingsThatTakeTheClothAlongAreNone) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const TriMesh ball = scaled(icosphere(3), Vec3::Constant(0.1));
    const Vec3 way(0.3, 0.4, 0.0);
    const Obstacle carrying =
        moving(ball, pose_of({0, -0.101, 0}), pose_of(Vec3(0, -0.101, 0) + way));
    TunnellingDetector detector(garment);
    EXPECT_TRUE(detector.find(boundary_of({carrying}), x, shifted(x, way), 0).empty());
    EXPECT_FALSE(detector.find(boundary_of({carrying}), x, x, 0).empty());
}

class ShallowEnds : public ::testing::TestWithParam<bool> {
 protected:
    /// A plate 4 cm thick that moves from `from` to `to` (heights of its middle) through the sheet.
    std::set<int> through(double from, double to) {
        const Pose start = pose_of({0, from, 0}), end = pose_of({0, to, 0});
        const Obstacle plate =
            GetParam() ? moving(scaled(cube(), {0.3, 0.02, 0.3}), start, end)
                       : moving(primitive(ObstacleShape::box, {0.3, 0.02, 0.3}, 0.0), start, end);
        const Points& x = m_garment.rest().vertices;
        std::set<int> found;
        for (const int i : vertices_of(m_tunnelling.find(boundary_of({plate}), x, x, 0), x.rows()))
            if (x.row(i).cwiseAbs().maxCoeff() < 0.28) found.insert(i);  // not near its sides
        return found;
    }
    const Garment m_garment = sheet();
    TunnellingDetector m_tunnelling{m_garment};
};

TEST_P(ShallowEnds, CountAsOutside) {
    const std::set<int> all = through(-0.03, 0.03);
    EXPECT_GT(all.size(), 50u);
    EXPECT_EQ(through(-0.018, 0.03), all) << "starts 2 mm inside";
    EXPECT_EQ(through(-0.03, 0.018), all) << "ends 2 mm inside";
    EXPECT_EQ(through(-0.018, 0.018), GetParam() ? std::set<int>() : all)
        << "both: in a mesh they cross nothing";
    EXPECT_TRUE(through(-0.03, -0.018).empty()) << "barely in";
    EXPECT_TRUE(through(-0.018, -0.03).empty()) << "led out where it came in";
    EXPECT_TRUE(through(-0.018, -0.016).empty()) << "a bit deeper";
}

TEST_P(ShallowEnds, ButDeepOnesDoNot) {
    EXPECT_FALSE(through(-0.03, 0.0).empty()) << "ends 2 cm inside";
    EXPECT_TRUE(through(-0.01, 0.03).empty()) << "starts 1 cm inside: nobody knows on which side";
}

INSTANTIATE_TEST_SUITE_P(MeshAndPrimitive, ShallowEnds, ::testing::Bool(),
                         [](const auto& scene) { return scene.param ? "mesh" : "box"; });

TEST(Tunnelling, PassOverPinsAndIgnoredLimbs) {
    const TriMesh plate = scaled(cube(), {0.3, 0.01, 0.3});
    Obstacle obstacle = moving(plate, pose_of({0, -0.03, 0}), pose_of({0, 0.04, 0}));
    obstacle.limbs = std::make_shared<std::vector<std::uint8_t>>(12, std::uint8_t(3));
    Boundary boundary = boundary_of({obstacle});
    const Garment free = sheet();
    const Points& x = free.rest().vertices;
    TunnellingDetector detector(free);
    const std::set<int> through = vertices_of(detector.find(boundary, x, x, 0), x.rows());
    ASSERT_GT(through.size(), 10u);
    const int first = *through.begin(), last = *through.rbegin();

    const Garment pinned = sheet({first});
    std::set<int> expected = through;
    expected.erase(first);
    EXPECT_EQ(vertices_of(TunnellingDetector(pinned).find(boundary, x, x, 0), x.rows()), expected);

    boundary.ignored_limbs.assign(static_cast<size_t>(x.rows()), 1u << 2);
    boundary.ignored_limbs[static_cast<size_t>(last)] = 1u << 3;
    expected = through;
    expected.erase(last);
    EXPECT_EQ(vertices_of(detector.find(boundary, x, x, 0), x.rows()), expected);
}

TEST(Tunnelling, PassOverIgnoredSolids) {
    const Pose from = pose_of({0, -0.03, 0}), to = pose_of({0, 0.04, 0});
    for (Obstacle obstacle :
         {moving(scaled(cube(), {0.3, 0.01, 0.3}), from, to),
          moving(primitive(ObstacleShape::box, {0.3, 0.01, 0.3}, 0.0), from, to)}) {
        obstacle.solid = 1u << 31;
        Boundary boundary = boundary_of({obstacle});
        const Garment garment = sheet();
        const Points& x = garment.rest().vertices;
        TunnellingDetector detector(garment);
        std::set<int> expected = vertices_of(detector.find(boundary, x, x, 0), x.rows());
        ASSERT_GT(expected.size(), 10u);
        const int last = *expected.rbegin();
        boundary.ignored_limbs.assign(static_cast<size_t>(x.rows()), 1u << 30);
        boundary.ignored_limbs[static_cast<size_t>(last)] = 1u << 31;
        expected.erase(last);
        EXPECT_EQ(vertices_of(detector.find(boundary, x, x, 0), x.rows()), expected);
    }
}

TEST(Tunnelling, LimbsOutOfRangeAreNone) {
    const TriMesh plate = scaled(cube(), {0.3, 0.01, 0.3});
    Obstacle obstacle = moving(plate, pose_of({0, -0.03, 0}), pose_of({0, 0.04, 0}));
    Boundary boundary = boundary_of({obstacle});
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    TunnellingDetector detector(garment);
    const std::set<int> through = vertices_of(detector.find(boundary, x, x, 0), x.rows());
    ASSERT_GT(through.size(), 10u);
    boundary.ignored_limbs.assign(static_cast<size_t>(x.rows()), ~LimbSet(0));
    for (const size_t faces : {size_t(12), size_t(11)}) {
        boundary.obstacles[0].limbs =
            std::make_shared<std::vector<std::uint8_t>>(faces, std::uint8_t(faces == 12 ? 200 : 0));
        EXPECT_EQ(vertices_of(detector.find(boundary, x, x, 0), x.rows()), through);
        for (const Tunnelling& solid : detector.found()) EXPECT_FALSE(solid.limb);
    }
}

TEST(Tunnelling, FromOneLimbIntoAnotherAreFolds) {
    // two blocks that overlap, as at a groin: in at the lower one, out at the upper one
    const TriMesh lower = scaled(cube(), {0.3, 0.02, 0.3});
    TriMesh both{Points(16, 3), Faces(24, 3)};
    both.vertices << lower.vertices, shifted(lower.vertices, {0, 0.03, 0});
    both.faces << lower.faces, lower.faces.array() + 8;
    Obstacle body = moving(both, pose_of({0, 0.03, 0}), pose_of({0, -0.07, 0}));
    auto limbs = std::make_shared<std::vector<std::uint8_t>>(24, std::uint8_t(0));
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    TunnellingDetector detector(garment);
    EXPECT_FALSE(detector.find(boundary_of({body}), x, x, 0).empty());
    body.limbs = limbs;
    EXPECT_FALSE(detector.find(boundary_of({body}), x, x, 0).empty());
    for (const Tunnelling& solid : detector.found()) EXPECT_EQ(solid.limb, 0);
    auto two = std::make_shared<std::vector<std::uint8_t>>(*limbs);
    std::fill(two->begin() + 12, two->end(), std::uint8_t(1));
    body.limbs = two;
    EXPECT_TRUE(detector.find(boundary_of({body}), x, x, 0).empty());
}

/// A finger of 14 mm that goes 3 cm upwards, through the middle of a face of the sheet y = 0.
struct Finger {
    Finger() : garment(sheet()) {
        const Points& x = garment.rest().vertices;
        const Faces& faces = garment.rest().faces;
        double least = 1.0;
        for (Eigen::Index f = 0; f < faces.rows(); ++f) {
            const Vec3 at = (x.row(faces(f, 0)) + x.row(faces(f, 1)) + x.row(faces(f, 2))) / 3.0;
            if (!(at.norm() < least)) continue;
            least = at.norm();
            face = static_cast<int>(f);
            centre = at;
        }
        obstacle = at_heights(-0.05, -0.02);
    }
    /// Of its middle; it is 8 cm long.
    Obstacle at_heights(double from, double to) const {
        return moving(scaled(cube(), {0.007, 0.04, 0.007}), pose_of(centre + Vec3(0, from, 0)),
                      pose_of(centre + Vec3(0, to, 0)));
    }
    Garment garment;
    int face = -1;
    Vec3 centre;
    Obstacle obstacle;
};

TEST(Tunnelling, OfFacesThatAFingerPiercedAreThoseOfTheirSamples) {
    const Finger finger;
    const Points& x = finger.garment.rest().vertices;
    const auto count = static_cast<int>(x.rows());
    const Boundary boundary = boundary_of({finger.obstacle});
    TunnellingDetector detector(finger.garment);
    ASSERT_TRUE(detector.find(boundary, x, x, 0).empty()) << "no vertex meets it";
    detector.add_samples(boundary, x, x, 1e-3);
    ASSERT_FALSE(detector.found().empty());
    bool found_face = false;
    for (const Tunnelling& through : detector.found()) {
        ASSERT_GE(through.point, count);
        found_face = found_face || through.point == count + finger.face;
        EXPECT_EQ(through.obstacle, 0);
        EXPECT_FALSE(through.limb);
        EXPECT_NEAR(through.thickness, 0.02, 1e-9) << "as deep as it went";
        EXPECT_NEAR(through.in.normal1.y(), 1.0, 1e-9) << "at the tip, not at a side";
        EXPECT_NEAR(through.in.point1.y(), 0.02, 1e-9);
        EXPECT_NEAR(through.in.point0.y(), -0.01, 1e-9);
    }
    EXPECT_TRUE(found_face);
    Points held = x;
    SurfaceContacts contacts;
    Proximity().query(x, boundary, contacts, StepEnd::end);
    detector.hold_where_they_went_in(contacts, held);
    EXPECT_EQ(contacts.ridges.size(), detector.found().size());
}

TEST(Tunnelling, SamplesThatWereInsideBeforeOrInAFoldHaveNoWayIn) {
    Finger finger;
    const Points& x = finger.garment.rest().vertices;
    TunnellingDetector detector(finger.garment);
    const auto count = [&](const Obstacle& obstacle) {
        const Boundary boundary = boundary_of({obstacle});
        detector.find(boundary, x, x, 0);
        detector.add_samples(boundary, x, x, 1e-3);
        return detector.found().size();
    };
    EXPECT_GT(count(finger.obstacle), 0u);
    EXPECT_EQ(count(finger.at_heights(-0.03, -0.0)), 0u) << "inside before";
    EXPECT_EQ(count(finger.at_heights(-0.02, -0.02)), 0u) << "nothing moves";
    // its tip is another limb
    const Faces& faces = *finger.obstacle.faces;
    auto limbs = std::make_shared<std::vector<std::uint8_t>>();
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        double lowest = 1.0;
        for (int k = 0; k < 3; ++k) lowest = std::min(lowest, finger.obstacle.x1(faces(f, k), 1));
        limbs->push_back(lowest > 0.0 ? 1 : 0);
    }
    finger.obstacle.limbs = limbs;
    EXPECT_EQ(count(finger.obstacle), 0u) << "a fold";
    std::fill(limbs->begin(), limbs->end(), std::uint8_t(1));
    EXPECT_GT(count(finger.obstacle), 0u);
    for (const Tunnelling& through : detector.found()) EXPECT_EQ(through.limb, 1);
}

TEST(Tunnelling, DependOnTheArgumentsAlone) {
    const Garment garment = sheet();
    const Points& x0 = garment.rest().vertices;
    const Points x1 = shifted(x0, {0.02, -0.2, 0.01});
    const TriMesh rough = scaled(roughened(icosphere(3), 0.1, 1), {0.3, 0.05, 0.2});
    Boundary boundary =
        boundary_of({moving(rough, pose_of({0, -0.1, 0}), pose_of({0, -0.1, 0}, 0.2)),
                     moving(primitive(ObstacleShape::sphere, Vec3::Zero(), 0.05),
                            pose_of({0.4, -0.1, 0.4}), pose_of({0.4, -0.1, 0.4}))});
    boundary.obstacles.push_back(boundary.obstacles[0]);  // the same faces twice
    TunnellingDetector fresh(garment), used(garment);
    const std::vector<Tunnelling> once = fresh.find(boundary, x0, x1, 1);
    EXPECT_GT(once.size(), 20u);
    used.find(boundary_of({moving(rough, pose_of({1, 2, 3}), pose_of({0, 0, 0}))}), x1, x0, 2);
    used.find(boundary, x0, x1, 2);
    ASSERT_EQ(used.found().size(), once.size());
    for (size_t k = 0; k < once.size(); ++k) {
        EXPECT_EQ(used.found()[k].point, once[k].point);
        EXPECT_EQ(used.found()[k].obstacle, once[k].obstacle);
        EXPECT_EQ(used.found()[k].thickness, once[k].thickness);
    }
}

TEST(Tunnelling, UnusableObstaclesArePassedOver) {
    const Garment garment = sheet();
    const Points& x = garment.rest().vertices;
    const TriMesh plate = scaled(cube(), {0.3, 0.01, 0.3});
    const Obstacle good = moving(plate, pose_of({0, -0.03, 0}), pose_of({0, 0.04, 0}));
    Obstacle no_faces = good, short_x1 = good, out_of_range = good, not_finite = good;
    no_faces.faces = nullptr;
    short_x1.x1 = good.x1.topRows(4);
    Faces faces = plate.faces;
    faces(3, 1) = 99;
    out_of_range.faces = std::make_shared<const Faces>(faces);
    not_finite.x1(2, 0) = std::nan("");
    Obstacle no_size = primitive(ObstacleShape::sphere, Vec3::Zero(), -1.0);
    TunnellingDetector detector(garment);
    EXPECT_TRUE(
        detector.find(boundary_of({no_faces, short_x1, out_of_range, not_finite, no_size}), x, x, 0)
            .empty());
    const auto& found = detector.find(boundary_of({out_of_range, good}), x, x, 0);
    ASSERT_FALSE(found.empty());
    for (const Tunnelling& solid : found) EXPECT_EQ(solid.obstacle, 1);
}

}  // namespace
}  // namespace cloth::tunnelling_test
