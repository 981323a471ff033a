#include "gnn/physics/stepper/boundary_part.h"

#include <gtest/gtest.h>

#include <vector>

#include "data/authoring/sheet.h"

namespace cloth::boundary_part_test {
namespace {

TEST(BoundaryPart, PartsOfAMotionJoinAndEndWhereItEnds) {
    const Garment garment("sheet", make_sheet(0.3, 0.3, 80), Fabric::soft_cotton(), {0, 3});
    const ClothState state = ClothState::at_rest(garment);
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.radius = 0.1;
    ball.friction = 0.3;
    ball.pose0.translation() = Vec3(1, 0, 0);
    ball.pose1.translation() = Vec3(2, 0.3, 0);
    ball.pose1.linear() = Eigen::AngleAxisd(1.0, Vec3::UnitY()).toRotationMatrix();
    Obstacle mesh;
    mesh.faces = std::make_shared<const Faces>(garment.rest().faces);
    mesh.x0 = garment.rest().vertices;
    mesh.x1 = mesh.x0.array() + 0.7;
    Boundary boundary;
    boundary.obstacles = {ball, mesh};
    boundary.gravity = Vec3(1, 2, 3);
    boundary.pin_targets.resize(2, 3);
    boundary.pin_targets.row(0) = state.x.row(0);
    boundary.pin_targets.row(1) = state.x.row(3) + Vec3(0, 0.06, 0).transpose();

    BoundaryPart part;
    part.begin(garment, state, boundary, 3);
    std::vector<Boundary> parts;
    for (int k = 0; k < 3; ++k) parts.push_back(part.take(k));
    EXPECT_EQ(parts[0].obstacles[1].x0, mesh.x0);
    EXPECT_EQ(parts[2].obstacles[1].x1, mesh.x1);
    EXPECT_EQ(parts[2].pin_targets, boundary.pin_targets);
    EXPECT_TRUE(parts[0].obstacles[0].pose0.matrix() == ball.pose0.matrix());
    EXPECT_TRUE(parts[2].obstacles[0].pose1.matrix() == ball.pose1.matrix());
    for (size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(parts[k].obstacles[1].x1, parts[k + 1].obstacles[1].x0);
        EXPECT_TRUE(parts[k].obstacles[0].pose1.matrix() ==
                    parts[k + 1].obstacles[0].pose0.matrix());
        EXPECT_EQ(parts[k].gravity, boundary.gravity);
        EXPECT_EQ(parts[k].obstacles[0].radius, ball.radius);
        EXPECT_EQ(parts[k].obstacles[0].friction, ball.friction);
    }
    const double angle =
        Eigen::AngleAxisd(Eigen::Matrix3d(parts[0].obstacles[0].pose1.linear())).angle();
    EXPECT_NEAR(angle, 1.0 / 3.0, 1e-12);
    EXPECT_NEAR(parts[0].obstacles[0].pose1.translation().x(), 4.0 / 3.0, 1e-12);
    EXPECT_NEAR(parts[0].pin_targets(1, 1), garment.rest().vertices(3, 1) + 0.02, 1e-12);

    BoundaryPart flat;
    flat.begin(garment, state, boundary, 3, BoundaryPart::Surfaces::left_out);
    const Boundary& first = flat.take(0);
    ASSERT_EQ(first.obstacles.size(), 2u);
    EXPECT_EQ(first.obstacles[0].friction, ball.friction);
    EXPECT_EQ(first.obstacles[1].x0.rows(), 0);
    EXPECT_EQ(first.pin_targets, parts[0].pin_targets);
}

}  // namespace
}  // namespace cloth::boundary_part_test
