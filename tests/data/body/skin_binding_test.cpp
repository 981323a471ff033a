#include "data/body/skin_binding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/body/skinned_character.h"
#include "data/core/errors.h"
#include "data/core/paths.h"

namespace cloth::skin_binding_test {

namespace {

/// A tetrahedron, outside of which the points lie.
TriMesh skin() {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.faces.resize(4, 3);
    mesh.faces << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    return mesh;
}

Points points() {
    Points p(4, 3);
    p << 0.3, 0.3, -0.01,   // above a face
        0.5, -0.02, -0.02,  // beside an edge
        1.1, 0, 0,          // beyond a corner
        0.4, 0.4, 0.4;      // above the slanted face
    return p;
}

}  // namespace

TEST(SkinBinding, PointsStayWhereTheyWereBound) {
    const SkinBinding binding(skin(), points());
    EXPECT_LT((binding.positions(skin().vertices) - points()).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_NEAR(binding.farthest(), 0.2 / std::sqrt(3.0), 1e-12);  // the last point
}

TEST(SkinBinding, RigidMotionTakesPointsAlong) {
    const SkinBinding binding(skin(), points());
    const Eigen::Isometry3d motion =
        Eigen::Translation3d(1, -2, 3) * Eigen::AngleAxisd(2.1, Vec3(1, 2, -0.5).normalized());
    const auto moved = [&](const Points& x) -> Points {
        return (motion * x.transpose()).transpose();
    };
    EXPECT_LT((binding.positions(moved(skin().vertices)) - moved(points())).cwiseAbs().maxCoeff(),
              1e-12);
}

TEST(SkinBinding, OtherSkinsAreRefused) {
    const SkinBinding binding(skin(), points());
    EXPECT_THROW(binding.positions(Points::Zero(3, 3)), ArgumentError);
    EXPECT_THROW(SkinBinding(TriMesh{}, points()), ArgumentError);
    Points bad = points();
    bad(0, 0) = NAN;
    EXPECT_THROW(SkinBinding(skin(), bad), ArgumentError);
}

TEST(SkinBinding, ABandFollowsACharacter) {
    // Khronos' strip: its upper half turns by 90 degrees about (0, 1, 0) until 1 s; the edges
    // at both ends follow one joint each.
    const SkinnedCharacter strip(model_path("glTF2/simple_skin/simple_skin.gltf"));
    Points band(2, 3);
    band << 0.25, 2, 0.02, 0.25, 0, 0.02;
    const SkinBinding binding({strip.rest_vertices(), *strip.faces()}, band);
    const Points bent = binding.positions(strip.vertices(1.0));
    EXPECT_LT((Vec3(bent.row(0)) - Vec3(-1, 1.25, 0.02)).norm(), 1e-6);
    EXPECT_LT((Vec3(bent.row(1)) - Vec3(0.25, 0, 0.02)).norm(), 1e-6);
}

}  // namespace cloth::skin_binding_test
