#include "collision/proximity/brute_force.h"

#include <gtest/gtest.h>

#include "tests/test_meshes.h"

namespace cloth::brute_force_test {
namespace {

using namespace test;

/// Signed distance of a cube of side 2, known exactly; its edges and corners are where a sign taken
/// from one face's normal fails.
double cube_distance(const Vec3& q) {
    const Vec3 outside = q.cwiseAbs() - Vec3::Ones();
    return outside.cwiseMax(0.0).norm() + std::min(0.0, outside.maxCoeff());
}

TEST(BruteForce, IsExactOnACube) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 2000; ++trial) {
        const Vec3 q = random_point(random, 2.0);
        EXPECT_NEAR(brute_force_signed_distance(cube(), q), cube_distance(q), 1e-12);
    }
}

/// For a point p of a star-shaped surface around the origin, s p is inside exactly if s < 1.
TEST(BruteForce, SignIsRightOnASpikySurface) {
    const TriMesh mesh = roughened(icosphere(2), 0.4, 2);
    std::mt19937 random(3);
    int inside = 0;
    for (int trial = 0; trial < 500; ++trial) {
        const auto face = static_cast<Eigen::Index>(random() % size_t(mesh.faces.rows()));
        const Vec3 w = random_point(random, 0.5) + Vec3::Constant(0.6);
        Vec3 on_surface = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
            on_surface += w[k] / w.sum() * mesh.vertices.row(mesh.faces(face, k)).transpose();
        const double scale = uniform(random, 0.3, 1.7);
        const double distance = brute_force_signed_distance(mesh, scale * on_surface);
        EXPECT_EQ(distance < 0.0, scale < 1.0) << "scale " << scale;
        inside += distance < 0.0;
    }
    EXPECT_GT(inside, 100);
}

TEST(BruteForce, AnObstacleMovesBetweenTheEnds) {
    Obstacle sphere = primitive(ObstacleShape::sphere, Vec3::Zero(), 1.0);
    sphere.pose1 = pose_of({0, 3, 0});
    const Boundary boundary = boundary_of({sphere});
    EXPECT_DOUBLE_EQ(brute_force_signed_distance(boundary, StepEnd::start, {0, 3, 0}), 2.0);
    EXPECT_DOUBLE_EQ(brute_force_signed_distance(boundary, StepEnd::end, {0, 3, 0}), -1.0);
}

}  // namespace
}  // namespace cloth::brute_force_test
