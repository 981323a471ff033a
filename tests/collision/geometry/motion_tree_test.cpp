#include "collision/geometry/motion_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "collision/ccd/fcl_sweep.h"
#include "tests/test_meshes.h"

namespace cloth::motion_tree_test {
namespace {

using namespace test;

std::set<int> met(const MotionTree& tree, const Vec3& p0, const Vec3& p1, float least_motion) {
    std::set<int> faces;
    std::vector<int> stack;
    tree.for_each_met(tree.box_of(p0, p1 - p0), least_motion, stack,
                      [&](int face) { EXPECT_TRUE(faces.insert(face).second); });
    return faces;
}

std::array<Vec3, 3> corners(const Points& x, const Faces& faces, int face) {
    return {x.row(faces(face, 0)), x.row(faces(face, 1)), x.row(faces(face, 2))};
}

class Trees : public ::testing::TestWithParam<double> {};

TEST_P(Trees, MissNoFaceThatAPointTouches) {
    const TriMesh mesh = roughened(icosphere(3), 0.2, 3);
    const Eigen::RowVector3d far(GetParam(), 0.0, -GetParam());
    std::mt19937 random(5);
    const Points x = mesh.vertices.rowwise() + far;
    const Points motion = random_points(random, x.rows(), 0.1).rowwise() + far / 10.0;
    MotionTree tree(mesh.vertices, mesh.faces);
    tree.refit(x, motion);
    int touches = 0;
    size_t tested = 0;
    constexpr int points = 300;
    for (int k = 0; k < points; ++k) {
        const Vec3 p0 = random_point(random, 1.3) + Vec3(far);
        const Vec3 p1 = p0 + random_point(random, 0.5) + Vec3(far) / 10.0;
        const std::set<int> found = met(tree, p0, p1, 0.0f);
        tested += found.size();
        for (int face = 0; face < mesh.faces.rows(); ++face) {
            double time = 0.0;
            if (!first_touch(p0, p1, corners(x, mesh.faces, face),
                             corners(x + motion, mesh.faces, face), time))
                continue;
            ++touches;
            EXPECT_TRUE(found.count(face)) << "point " << k << ", face " << face;
        }
    }
    EXPECT_GT(touches, 50);
    EXPECT_LT(tested, 0.1 * points * static_cast<double>(mesh.faces.rows()));
}

INSTANTIATE_TEST_SUITE_P(NearAndFar, Trees, ::testing::Values(0.0, 100.0));

TEST(MotionTree, LeavesOutWhatMovesAlong) {
    const TriMesh mesh = icosphere(2);
    const Points motion = Points::Constant(mesh.vertices.rows(), 3, 0.5);
    MotionTree tree(mesh.vertices, mesh.faces);
    tree.refit(mesh.vertices, motion);
    const Vec3 on_surface = mesh.vertices.row(0);
    const Vec3 along = on_surface + Vec3::Constant(0.5);
    EXPECT_FALSE(met(tree, on_surface, along, 0.0f).empty());
    EXPECT_TRUE(met(tree, on_surface, along, 1e-3f).empty());
    EXPECT_FALSE(met(tree, on_surface, along - Vec3(0.01, 0, 0), 1e-3f).empty());
}

TEST(MotionTree, OfNothingIsEmpty) {
    MotionTree tree(Points(0, 3), Faces(0, 3));
    tree.refit(Points(0, 3), Points(0, 3));
    EXPECT_TRUE(tree.is_empty());
    EXPECT_TRUE(met(tree, Vec3::Zero(), Vec3::Ones(), 0.0f).empty());
}

}  // namespace
}  // namespace cloth::motion_tree_test
