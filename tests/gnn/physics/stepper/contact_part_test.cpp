#include "gnn/physics/stepper/contact_part.h"

#include <gtest/gtest.h>

#include <vector>

#include "data/authoring/sheet.h"

namespace cloth::contact_part_test {
namespace {

constexpr int count = 5;

/// What a sheet has of a cube that moves 2 cm, turns by 0.3 and is 1 km from the origin, with a
/// ridge.
struct CubeUnderSheet {
    CubeUnderSheet() {
        Obstacle cube;
        cube.shape = ObstacleShape::box;
        cube.half_extents = Vec3(0.1, 0.1, 0.1);
        cube.pose0.translation() = far + Vec3(0, -0.11, 0);
        cube.pose1 = cube.pose0;
        cube.pose1.translation() += Vec3(0.02, 0, 0);
        cube.pose1.rotate(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        boundary.obstacles = {cube};
        x = make_sheet(0.4, 0.4, 200).vertices.rowwise() + far.transpose();
        Proximity().query(x, boundary, contacts);
        RidgeContact ridge{0, {1.0, 0.0, 0.0}, Vec3::UnitY(), 0.0};
        ridge.normal0 = Vec3(0, 1, 0);
        ridge.normal = Vec3(0, 1, 1).normalized();
        ridge.point0 = far + Vec3(0, 0.1, 0);
        ridge.point1 = far + Vec3(0, 0.2, 0);
        ridge.height = ridge.normal.dot(ridge.point1);
        contacts.ridges = {ridge};
    }
    const Vec3 far = Vec3(1000, 0, 0);
    Points x;
    SurfaceContacts contacts;
};

TEST(ContactPart, PartsJoinAndTheLastEndsWhereTheStepEnds) {
    const CubeUnderSheet scene;
    ContactPart part;
    part.begin(scene.contacts, count);
    std::vector<SurfaceContacts> parts;
    for (int k = 0; k < count; ++k) parts.push_back(part.take(k, scene.x));
    EXPECT_EQ(parts.front().point0, scene.contacts.point0);
    EXPECT_EQ(parts.front().normal0, scene.contacts.normal0);
    EXPECT_EQ(parts.front().distance, scene.contacts.distance);
    EXPECT_EQ(parts.back().point1, scene.contacts.point1);
    EXPECT_EQ(parts.back().normal1, scene.contacts.normal1);
    EXPECT_EQ(parts.back().ridges[0].normal, scene.contacts.ridges[0].normal);
    EXPECT_EQ(parts.back().ridges[0].height, scene.contacts.ridges[0].height);
    for (size_t k = 0; k + 1 < count; ++k) {
        EXPECT_EQ(parts[k].point1, parts[k + 1].point0);
        EXPECT_EQ(parts[k].normal1, parts[k + 1].normal0);
        EXPECT_EQ(parts[k].ridges[0].normal, parts[k + 1].ridges[0].normal0);
    }
    // A second step begins afresh.
    EXPECT_EQ(part.take(0, scene.x).point1, parts[0].point1);
}

TEST(ContactPart, PlanesMoveEvenlyAndNormalsStayUnitVectors) {
    const CubeUnderSheet scene;
    ContactPart part;
    part.begin(scene.contacts, count);
    int contacts = 0;
    for (int k = 0; k < count; ++k) {
        const SurfaceContacts& at = part.take(k, scene.x);
        const double s = (k + 1.0) / count;
        for (Eigen::Index i = 0; i < scene.x.rows(); ++i) {
            if (!at.has(i)) continue;
            ++contacts;
            EXPECT_NEAR(at.normal1.row(i).norm(), 1.0, 1e-12);
            const Eigen::RowVector3d point =
                (1 - s) * scene.contacts.point0.row(i) + s * scene.contacts.point1.row(i);
            EXPECT_LT((at.point1.row(i) - point).norm(), 1e-9);
            if (k > 0) {
                EXPECT_NEAR(at.distance[i],
                            at.normal0.row(i).dot(scene.x.row(i) - at.point0.row(i)), 1e-9);
            }
        }
        const RidgeContact& ridge = at.ridges[0];
        EXPECT_NEAR(ridge.normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(ridge.height, ridge.normal.dot(scene.far + Vec3(0, 0.1 + 0.1 * s, 0)), 1e-9)
            << "the plane goes through the surface point, however far from the origin";
    }
    EXPECT_GT(contacts, 100);
}

TEST(ContactPart, WithoutContactsThereIsNothingToCut) {
    SurfaceContacts none;
    ContactPart part;
    part.begin(none, count);
    EXPECT_TRUE(part.take(1, Points::Zero(4, 3)).obstacle.empty());
}

}  // namespace
}  // namespace cloth::contact_part_test
