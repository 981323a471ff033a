#include "demos/bake/slip_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/core/garment_pieces.h"
#include "tests/test_meshes.h"

namespace cloth::slip_check_test {

using namespace test;

namespace {

constexpr double height = 1.7;

/// A tube round the y axis, open at its ends.
TriMesh tube(double radius, double low, double high) {
    constexpr int sides = 24, rings = 30;
    TriMesh mesh;
    mesh.vertices.resize(sides * rings, 3);
    mesh.faces.resize(2 * sides * (rings - 1), 3);
    Eigen::Index face = 0;
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const double angle = 2.0 * M_PI * s / sides;
            mesh.vertices.row(r * sides + s) << radius * std::sin(angle),
                low + (high - low) * r / (rings - 1), radius * std::cos(angle);
            if (r + 1 == rings) continue;
            const int a = r * sides + s, b = r * sides + (s + 1) % sides;
            mesh.faces.row(face++) << a, b, b + sides;
            mesh.faces.row(face++) << a, b + sides, a + sides;
        }
    return mesh;
}

Garment garment_of(const TriMesh& mesh, const std::vector<int>& pins = {}) {
    return Garment("garment", mesh, Fabric::soft_cotton(), pins);
}

/// A trunk, and on it a shirt and trousers that are not joined.
class SlipOfASuit : public testing::Test {
 protected:
    const TriMesh trunk = tube(0.15, 0.0, height);
    const Garment shirt = garment_of(tube(0.16, 1.0, 1.5)),
                  trousers = garment_of(tube(0.16, 0.2, 1.0));
    const MergedGarments suit = merge_garments("suit", {shirt, trousers});
    const Points start = suit.garment.rest().vertices;
    const SlipCheck check{suit.garment, start, trunk, height};

    Points trousers_lower_by(double way) const {
        Points x = start;
        x.bottomRows(trousers.vertex_count()).col(1).array() -= way;
        return x;
    }
};

}  // namespace

TEST_F(SlipOfASuit, OneOfItsPiecesIsNamedWithItsWay) {
    for (const double way : {0.25, 0.4, 33.0}) {
        const std::vector<Slip> slips = check.slips(trunk.vertices, trousers_lower_by(way));
        ASSERT_EQ(slips.size(), 1u) << way;
        EXPECT_EQ(slips[0].piece, 1);
        EXPECT_NEAR(slips[0].way, way, 0.02);
        const std::string message = slip_message(slips);
        EXPECT_NE(message.find("piece 2 of 2 slid off: it is "), std::string::npos) << message;
        EXPECT_NE(message.find("give --pin LOW HIGH"), std::string::npos) << message;
    }
}

TEST_F(SlipOfASuit, WaistbandsMaySettleOnTheHips) {
    EXPECT_TRUE(check.slips(trunk.vertices, start).empty());
    EXPECT_TRUE(check.slips(trunk.vertices, trousers_lower_by(0.15)).empty());
    EXPECT_EQ(slip_message({}), "");
}

TEST_F(SlipOfASuit, ClothMayTurnRoundTheBody) {
    const Eigen::AngleAxisd quarter(0.5 * M_PI, Vec3::UnitY());
    const Points x = start * quarter.toRotationMatrix().transpose();
    EXPECT_TRUE(check.slips(trunk.vertices, x).empty());
}

TEST_F(SlipOfASuit, TheSkinTakesItsPlacesAlong) {
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(1.0, Vec3::UnitX()).toRotationMatrix();
    const auto moved = [&](const Points& x) {
        return Points((x * turned.transpose()).rowwise() + Eigen::RowVector3d(5.0, 0.0, 1.0));
    };
    EXPECT_TRUE(check.slips(moved(trunk.vertices), moved(start)).empty());
    EXPECT_EQ(check.slips(moved(trunk.vertices), start).size(), 2u) << "the body went off alone";
    EXPECT_EQ(check.slips(moved(trunk.vertices), moved(trousers_lower_by(0.3))).size(), 1u);
}

TEST_F(SlipOfASuit, PinnedClothMaySwingFarther) {
    const Garment pinned = garment_of(trousers.rest(), {0});
    const SlipCheck of_pinned(pinned, pinned.rest().vertices, trunk, height);
    Points x = pinned.rest().vertices;
    x.col(1).array() -= 0.25;
    EXPECT_TRUE(of_pinned.slips(trunk.vertices, x).empty());
    x.col(1).array() -= 0.25;
    EXPECT_NE(slip_message(of_pinned.slips(trunk.vertices, x)).find("the garment came off"),
              std::string::npos);
}

// A flat sheet above a ball comes down all over it: its edge goes far, and its middle stays.
TEST(SlipOfAPoncho, ASheetThatDrapesIsNotOneThatSlidOff) {
    const double radius = 0.4;
    const TriMesh ball = sphere_mesh(radius, 24);
    TriMesh sheet = square_mesh(25);
    sheet.vertices.rowwise() -= Eigen::RowVector3d(0.5, 0.0, 0.5);
    sheet.vertices.col(1).array() += radius + 0.06;
    const Garment poncho = garment_of(sheet);
    const SlipCheck check(poncho, sheet.vertices, ball, height);
    Points draped = sheet.vertices;
    for (Eigen::Index i = 0; i < draped.rows(); ++i) {
        const double out = std::hypot(draped(i, 0), draped(i, 2)), r = radius + 0.005,
                     angle = std::min(out / r, 0.5 * M_PI), across = r * std::sin(angle);
        if (out == 0.0) continue;
        draped(i, 0) *= across / out;
        draped(i, 2) *= across / out;
        draped(i, 1) = r * std::cos(angle) - std::max(0.0, out - 0.5 * M_PI * r);
    }
    EXPECT_GT((draped - sheet.vertices).rowwise().norm().maxCoeff(), 0.3);
    EXPECT_TRUE(check.slips(ball.vertices, draped).empty());
    draped.col(1).array() -= 0.5;
    EXPECT_EQ(check.slips(ball.vertices, draped).size(), 1u);
}

}  // namespace cloth::slip_check_test
