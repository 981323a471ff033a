#include <gtest/gtest.h>

#include "bullet_ext/bodySegments.h"
#include "bullet_ext/bulletShapes.h"
#include "data/core/errors.h"
#include "tests/test_meshes.h"

namespace cloth::body_segments_test {

using namespace cloth::test;

namespace {

/// A banana: a sphere stretched along x and bent, so that its hull stands off.
TriMesh banana() {
    TriMesh mesh = sphere_mesh(0.1, 20);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        double& x = mesh.vertices(i, 0);
        x *= 6.0;
        mesh.vertices(i, 1) += 0.8 * x * x;
    }
    return mesh;
}

double worst(const std::vector<BodySegment>& segments) {
    double standoff = 0.0;
    for (const BodySegment& segment : segments)
        standoff = std::max(standoff, hull_standoff(segment));
    return standoff;
}

std::vector<TriMesh> hulls_of(const std::vector<BodySegment>& segments) {
    std::vector<TriMesh> hulls;
    for (const BodySegment& segment : segments)
        hulls.push_back(convexHull(segment.hull_points_rest));
    return hulls;
}

/// True if some hull holds the point, within the 0.1 mm to which Bullet computes hulls.
bool is_covered(const std::vector<TriMesh>& hulls, const Vec3& point) {
    for (const TriMesh& hull : hulls) {
        bool inside = true;
        for (Eigen::Index f = 0; f < hull.faces.rows() && inside; ++f) {
            const Vec3 a = hull.vertices.row(hull.faces(f, 0));
            const Vec3 b = hull.vertices.row(hull.faces(f, 1));
            const Vec3 c = hull.vertices.row(hull.faces(f, 2));
            inside = (point - a).dot((b - a).cross(c - a).normalized()) < 2e-4;
        }
        if (inside) return true;
    }
    return false;
}

}  // namespace

TEST(BodySegments, AConvexBodyIsItsOwnHull) {
    const TriMesh ball = sphere_mesh(0.3, 10);
    const auto segments =
        segment_body(ball, std::vector<int>(static_cast<size_t>(ball.vertices.rows()), 7), 70);
    ASSERT_EQ(segments.size(), 1u);
    EXPECT_EQ(segments[0].joint, 7);
    EXPECT_LT(hull_standoff(segments[0]), 1e-6);
    EXPECT_EQ(segments[0].hull_points_rest.rows(), ball.vertices.rows());
}

TEST(BodySegments, MorePiecesFitBetterAndLeaveNoGap) {
    const TriMesh body = banana();
    const std::vector<int> joints(static_cast<size_t>(body.vertices.rows()), 0);
    const double one = worst(segment_body(body, joints, 1));
    const double four = worst(segment_body(body, joints, 4));
    const auto many = segment_body(body, joints, 16);
    EXPECT_LE(many.size(), 16u);
    EXPECT_LT(four, 0.5 * one);
    EXPECT_LT(worst(many), 0.15 * one);
    const std::vector<TriMesh> hulls = hulls_of(many);
    for (Eigen::Index f = 0; f < body.faces.rows(); ++f) {
        Vec3 middle = Vec3::Zero();
        for (int c = 0; c < 3; ++c) middle += body.vertices.row(body.faces(f, c)).transpose() / 3;
        EXPECT_TRUE(is_covered(hulls, middle)) << "face " << f;
    }
}

TEST(BodySegments, EveryJointHasAPieceOfItsOwn) {
    const TriMesh body = banana();
    std::vector<int> joints;
    for (Eigen::Index i = 0; i < body.vertices.rows(); ++i)
        joints.push_back(body.vertices(i, 0) < 0 ? 3 : 5);
    const auto segments = segment_body(body, joints, 2);
    ASSERT_EQ(segments.size(), 2u);
    EXPECT_EQ(segments[0].joint, 3);
    EXPECT_EQ(segments[1].joint, 5);
    EXPECT_LT(segments[0].rest.col(0).maxCoeff(), 0.2);
    EXPECT_GT(segments[1].rest.col(0).minCoeff(), -0.2);
}

TEST(BodySegments, BadInputIsRefused) {
    const TriMesh body = banana();
    EXPECT_THROW(segment_body(body, {1, 2}, 4), ArgumentError);
    const std::vector<int> joints(static_cast<size_t>(body.vertices.rows()), 0);
    EXPECT_THROW(segment_body(body, joints, 0), ArgumentError);
    EXPECT_THROW(segment_body({}, {}, 4), ArgumentError);
}

}  // namespace cloth::body_segments_test
