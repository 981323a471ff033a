// Rays through ClosestFaceTree, against a loop over all faces.

#include <gtest/gtest.h>

#include "collision/proximity/closest_face_tree.h"
#include "data/core/triangle.h"
#include "tests/test_meshes.h"

namespace cloth::closest_face_rays_test {
namespace {

using namespace test;

/// The nearest face, the lowest of several as near.
std::optional<RayHit> slow_hit(const TriMesh& mesh, const std::vector<std::uint8_t>& limbs,
                               const Vec3& from, const Vec3& way, double length, LimbSet ignored) {
    std::optional<RayHit> first;
    double nearest = length;
    for (int f = 0; f < int(mesh.faces.rows()); ++f) {
        if ((ignored >> limbs[size_t(f)] & 1u) != 0) continue;
        const auto hit =
            meet_line(from, way, mesh.vertices.row(mesh.faces(f, 0)),
                      mesh.vertices.row(mesh.faces(f, 1)), mesh.vertices.row(mesh.faces(f, 2)));
        if (!hit || !hit->is_inside() || hit->at < 0.0 || !(hit->at < nearest)) continue;
        nearest = hit->at;
        first = RayHit{f, nearest};
    }
    return first;
}

TEST(ClosestFaceRays, MeetTheFirstFaceOfALimbThatCounts) {
    std::mt19937 random(8);
    int met = 0;
    for (TriMesh mesh : {icosphere(0), icosphere(3), roughened(torus(40, 20, 0.8, 0.3), 0.2, 3)}) {
        std::vector<std::uint8_t> limbs(size_t(mesh.faces.rows()));
        for (auto& limb : limbs) limb = std::uint8_t(random() % 3);
        ClosestFaceTree tree(mesh.vertices, mesh.faces, 0.5, &limbs);
        ClosestFaceTree::Stack stack;
        for (int trial = 0; trial < 600; ++trial) {
            if (trial == 300) {  // the mesh moves
                mesh.vertices.rowwise() += Eigen::RowVector3d(0.3, -0.2, 0.1);
                tree.refit(mesh.vertices);
            }
            const Vec3 from = random_point(random, 1.3);
            const Vec3 way = trial % 20 == 0 ? Vec3(Vec3::Unit(trial / 20 % 3))
                                             : Vec3(random_point(random, 1.0).normalized());
            const double length = uniform(random, 0.05, 3.0);
            const LimbSet ignored = trial % 3 == 0 ? random() % 8 : 0;
            const auto hit = tree.first_hit(from, way, length, stack, ignored);
            const auto expected = slow_hit(mesh, limbs, from, way, length, ignored);
            ASSERT_EQ(hit.has_value(), expected.has_value()) << trial;
            if (!hit) continue;
            ++met;
            EXPECT_EQ(hit->face, expected->face);
            EXPECT_NEAR(hit->distance, expected->distance, 1e-12);
        }
    }
    EXPECT_GT(met, 300);
}

}  // namespace
}  // namespace cloth::closest_face_rays_test
