#include "collision/proximity/ridge_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/core/fabric.h"
#include "tests/test_meshes.h"

namespace cloth::ridge_contacts_test {
namespace {

/// A strip of two faces over the edge of a box: two corners above the top, two beside the side.
struct StripOverEdge {
    Garment garment;
    Boundary boundary;
    Proximity proximity;
    SurfaceContacts contacts;
    Points x;

    explicit StripOverEdge(std::vector<int> pins = {}) : garment("strip", strip(), {}, pins) {
        Obstacle box;
        box.shape = ObstacleShape::box;
        box.half_extents = {1.0, 1.0, 1.0};
        box.pose0.translation() = Vec3(-1.0, -1.0, 0.0);  // its edge is the z axis
        box.pose1 = box.pose0;
        boundary.obstacles.push_back(box);
        boundary.pin_targets.setZero(static_cast<Eigen::Index>(pins.size()), 3);
        x.resize(4, 3);
        x << -0.01, 0.004, 0.0, 0.004, -0.01, 0.0, -0.01, 0.004, 0.02, 0.004, -0.01, 0.02;
    }
    static TriMesh strip() {
        TriMesh mesh{Points(4, 3), Faces(2, 3)};
        mesh.vertices << 0.0, 0.0, 0.0, 0.02, 0.0, 0.0, 0.0, 0.0, 0.02, 0.02, 0.0, 0.02;
        mesh.faces << 0, 2, 1, 1, 2, 3;
        return mesh;
    }
    const std::vector<RidgeContact>& find(StepEnd chosen_at = StepEnd::start) {
        proximity.query(x, boundary, contacts, chosen_at);
        RidgeFinder(garment).find(proximity, boundary, x, contacts, chosen_at);
        return contacts.ridges;
    }
    Vec3 point(const RidgeContact& ridge) const {
        Vec3 point = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
            point += ridge.weight[static_cast<size_t>(k)] *
                     x.row(garment.rest().faces(ridge.face, k)).transpose();
        return point;
    }
};

}  // namespace

TEST(RidgeFinder, FacesAndEdgesOverABoxEdgeGetTheTangentPlaneOfTheirNearestPoint) {
    StripOverEdge strip;
    const auto& ridges = strip.find();
    ASSERT_EQ(ridges.size(), 5u) << "two faces and the three edges that cross the ridge";
    for (const RidgeContact& ridge : ridges) {
        EXPECT_NEAR(ridge.normal.norm(), 1.0, 1e-12);
        EXPECT_NEAR(ridge.weight[0] + ridge.weight[1] + ridge.weight[2], 1.0, 1e-12);
        const Vec3 p = strip.point(ridge);
        const double outside = std::hypot(std::max(p.x(), 0.0), std::max(p.y(), 0.0));
        const double inside = -std::min(-p.x(), -p.y());
        const double distance = std::max(p.x(), p.y()) > 0.0 ? outside : inside;
        EXPECT_NEAR(ridge.normal.dot(p) - ridge.height, distance, 1e-9);
    }
}

TEST(RidgeFinder, SmoothSurfacesAndFarClothHaveNone) {
    StripOverEdge flat;
    flat.x.col(0).array() -= 0.1;
    flat.x.col(1).setConstant(0.004);
    EXPECT_TRUE(flat.find().empty());
    StripOverEdge far;
    far.x.leftCols<2>().array() += 0.09;
    EXPECT_TRUE(far.find().empty());
}

TEST(RidgeFinder, ValleysHaveNone) {
    StripOverEdge strip;
    Obstacle floor, wall;
    floor.shape = wall.shape = ObstacleShape::plane;
    wall.pose0.linear() = Eigen::AngleAxisd(-0.5 * M_PI, Vec3::UnitZ()).toRotationMatrix();
    wall.pose1 = wall.pose0;  // its normal is +x
    strip.boundary.obstacles = {floor, wall};
    strip.x << 0.004, 0.01, 0.0, 0.01, 0.004, 0.0, 0.004, 0.01, 0.02, 0.01, 0.004, 0.02;
    EXPECT_TRUE(strip.find().empty());
    ASSERT_NEAR(strip.contacts.normal0.row(0).dot(strip.contacts.normal0.row(1)), 0.0, 1e-9);
}

TEST(RidgeFinder, PinnedEdgesHaveNone) {
    StripOverEdge strip({0, 1, 2});
    for (const RidgeContact& ridge : strip.find()) EXPECT_EQ(ridge.face, 1);
    EXPECT_EQ(strip.contacts.ridges.size(), 2u) << "a face and the edge that crosses the ridge";
}

TEST(RidgeFinder, PlanesRideWithTheObstacle) {
    StripOverEdge strip;
    const std::vector<RidgeContact> still = strip.find();
    const Eigen::AngleAxisd turn(0.3, Vec3(1, 2, 3).normalized());
    Pose motion = Pose::Identity();
    motion.rotate(turn);
    motion.translation() = Vec3(0.1, 0.2, -0.1);
    strip.boundary.obstacles[0].pose1 = motion * strip.boundary.obstacles[0].pose0;
    const std::vector<RidgeContact> moved = strip.find();
    ASSERT_EQ(moved.size(), still.size());
    for (size_t k = 0; k < still.size(); ++k) {
        const Vec3 p = motion * strip.point(still[k]);
        EXPECT_NEAR(moved[k].normal.dot(p) - moved[k].height,
                    still[k].normal.dot(strip.point(still[k])) - still[k].height, 2e-4)
            << "the shortest rotation leaves the twist out";
        EXPECT_LT((moved[k].point0 - still[k].point0).norm(), 1e-12);
        EXPECT_LT((moved[k].point1 - motion * still[k].point1).norm(), 1e-12);
        EXPECT_LT((moved[k].normal0 - still[k].normal).norm(), 1e-9) << "as it is at the start";
        EXPECT_NEAR(moved[k].normal.dot(moved[k].point1), moved[k].height, 1e-12);
    }
}

TEST(RidgeFinder, NearestPointsMayBeChosenAtTheEnd) {
    StripOverEdge strip;
    const std::vector<RidgeContact> at_start = strip.find();
    strip.boundary.obstacles[0].pose0.translation().y() -= 0.5;
    const std::vector<RidgeContact> at_end = strip.find(StepEnd::end);
    ASSERT_EQ(at_end.size(), at_start.size());
    for (size_t k = 0; k < at_end.size(); ++k) {
        EXPECT_EQ(at_end[k].normal, at_start[k].normal);
        EXPECT_EQ(at_end[k].height, at_start[k].height);
    }
}

TEST(RidgeFinder, AQueryForgetsTheRidgesOfTheLast) {
    StripOverEdge strip;
    ASSERT_FALSE(strip.find().empty());
    strip.proximity.query(strip.x, strip.boundary, strip.contacts);
    EXPECT_TRUE(strip.contacts.ridges.empty());
}

}  // namespace cloth::ridge_contacts_test
