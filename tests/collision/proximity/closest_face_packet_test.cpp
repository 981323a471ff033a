#include <gtest/gtest.h>

#include "collision/geometry/spatial_order.h"
#include "collision/proximity/closest_face_tree.h"
#include "tests/test_meshes.h"

namespace cloth::closest_face_packet_test {
namespace {

using namespace test;
using Query = ClosestFaceTree::Query;

constexpr double not_finite = std::numeric_limits<double>::infinity();

/// Asks for the points together and one by one.
void expect_same_as_single(const ClosestFaceTree& tree, const std::vector<Query>& queries) {
    ClosestFaceTree::Stack stack;
    std::vector<FaceHit> hits(queries.size());
    tree.closest(queries.data(), static_cast<int>(queries.size()), stack, hits.data());
    for (size_t k = 0; k < queries.size(); ++k) {
        const Query& query = queries[k];
        const FaceHit single =
            tree.closest(query.x, query.radius, query.hint, stack, query.ignored);
        EXPECT_EQ(hits[k].face, single.face) << "point " << k << " of " << queries.size();
        EXPECT_EQ(hits[k].barycentric, single.barycentric);
        EXPECT_EQ(hits[k].squared, single.squared);
    }
}

/// Up to eight points near each other, or as far apart as the mesh is wide, some on its vertices.
/// Each looks as far as the radius, or less far.
std::vector<Query> random_queries(std::mt19937& random, const TriMesh& mesh, double radius) {
    const double spread = std::pow(10.0, uniform(random, -3.0, 0.3));
    const Vec3 middle = random_point(random, 1.2);
    std::vector<Query> queries(1 + random() % ClosestFaceTree::packet);
    for (Query& query : queries) {
        query.x = middle + random_point(random, spread);
        if (random() % 8 == 0)
            query.x = mesh.vertices.row(Eigen::Index(random() % size_t(mesh.vertices.rows())));
        if (random() % 2 == 0) query.hint = int(random() % size_t(mesh.faces.rows()));
        if (random() % 4 == 0) query.ignored = random() % 8;
        query.radius = random() % 4 == 0 ? uniform(random, 0.0, radius) : radius;
    }
    return queries;
}

std::vector<std::uint8_t> random_limbs(std::mt19937& random, const TriMesh& mesh) {
    std::vector<std::uint8_t> limbs(static_cast<size_t>(mesh.faces.rows()));
    for (auto& limb : limbs) limb = std::uint8_t(random() % 3);
    return limbs;
}

TriMesh flattened(TriMesh mesh, double height) {
    mesh.vertices.col(1) *= height;
    return mesh;
}

TriMesh scaled(TriMesh mesh, double scale, const Vec3& offset) {
    mesh.vertices *= scale;
    mesh.vertices.rowwise() += offset.transpose();
    return mesh;
}

TEST(ClosestFacePacket, PointsThatAreSearchedTogetherAnswerAsIfAlone) {
    std::mt19937 random(11);
    // the last ones have thin faces, needles, and faces without area
    for (const TriMesh& mesh :
         {icosphere(0), icosphere(4), cube(), roughened(torus(40, 20, 0.8, 0.3), 0.2, 3),
          torus(300, 5, 0.8, 0.3), flattened(icosphere(3), 1e-3), flattened(icosphere(3), 1e-7),
          flattened(cube(), 0.0)}) {
        const auto limbs = random_limbs(random, mesh);
        const ClosestFaceTree tree(mesh.vertices, mesh.faces, 3.0, &limbs);
        for (int trial = 0; trial < 400; ++trial)
            expect_same_as_single(
                tree,
                random_queries(random, mesh, trial % 2 == 0 ? 3.0 : uniform(random, 0.01, 0.5)));
    }
}

TEST(ClosestFacePacket, LargeMeshesFarFromTheOriginAnswerAsPointsAlone) {
    std::mt19937 random(12);
    const Vec3 offset(1e3, -2e3, 5e2);
    const TriMesh ground = scaled(roughened(icosphere(2), 0.1, 4), 100.0, offset);
    const ClosestFaceTree tree(ground.vertices, ground.faces, 200.0);
    for (int trial = 0; trial < 400; ++trial) {
        auto queries = random_queries(random, ground, 200.0);
        for (Query& query : queries)
            if (query.x.norm() < 10.0) query.x = 100.0 * query.x + offset;
        expect_same_as_single(tree, queries);
    }
}

TEST(ClosestFacePacket, FacesThatAreNotFiniteAndEmptyMeshesAreNoCandidates) {
    std::mt19937 random(13);
    TriMesh mesh = icosphere(2);
    for (int k = 0; k < 20; ++k)
        mesh.vertices(Eigen::Index(random() % 100), k % 3) = k % 2 ? not_finite : std::nan("");
    const ClosestFaceTree tree(mesh.vertices, mesh.faces, 3.0);
    const Faces none(0, 3);
    const ClosestFaceTree empty(mesh.vertices, none, 3.0);
    for (int trial = 0; trial < 200; ++trial) {
        auto queries = random_queries(random, icosphere(2), 3.0);
        expect_same_as_single(tree, queries);
        for (Query& query : queries) query.hint = -1;
        expect_same_as_single(empty, queries);
    }
}

/// There they are infinite, and boxes that are so far away as to be none hold nothing off.
TEST(ClosestFacePacket, PointsTooFarAwayForSinglePrecisionFindNothing) {
    std::mt19937 random(15);
    const TriMesh few{icosphere(0).vertices, icosphere(0).faces.topRows(3)};
    const ClosestFaceTree tree(few.vertices, few.faces, 3.0);
    for (const double far : {1e20, 1e39, 1e300})
        for (int trial = 0; trial < 50; ++trial) {
            std::vector<Query> queries(ClosestFaceTree::packet);
            for (Query& query : queries) {
                query.x = far * random_point(random, 1.0);
                if (trial % 2 == 0) query.x = -query.x.cwiseAbs();
                query.radius = 0.1;
            }
            if (trial % 3 == 0) queries[0].x.setZero();
            expect_same_as_single(tree, queries);
        }
}

TEST(SpatialOrder, RunsAreGroupsOfNeighbours) {
    std::mt19937 random(14);
    constexpr int run = 8;
    for (const Eigen::Index count : {0, 1, 7, 8, 9, 100, 4001}) {
        Points x = random_points(random, count, 1.0);
        if (count == 100) x(3, 1) = std::nan(""), x(50, 0) = not_finite;
        const std::vector<int> order = spatial_order(x, run);
        std::vector<char> seen(size_t(count), 0);
        for (const int i : order) ++seen.at(size_t(i));
        EXPECT_EQ(order.size(), size_t(count));
        EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](char times) { return times == 1; }));
        if (count == 100) {
            EXPECT_EQ(order[98] + order[99], 53) << "not finite: last";
        }
        if (count < 4001) continue;
        double extent = 0.0;
        for (size_t first = 0; first + run <= order.size(); first += run)
            for (size_t k = 1; k < run; ++k)
                extent = std::max(extent, (x.row(order[first + k]) - x.row(order[first])).norm());
        EXPECT_LT(extent, 1.0) << "of a cube of 2 m, 500 groups";
    }
}

}  // namespace
}  // namespace cloth::closest_face_packet_test
