#include "demos/viewer/wind.h"

#include <gtest/gtest.h>

#include <cmath>

#include "data/core/errors.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::viewer_wind_test {

namespace {

/// A flat sheet across the z-axis, at rest.
Garment upright_sheet() {
    TriMesh mesh = cloth::test::sheet(6, 0.3, 0.0);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        const Vec3 x = mesh.vertices.row(i);
        mesh.vertices.row(i) = Vec3(x.x(), x.z(), 0.0).transpose();
    }
    return {"sheet", mesh, Fabric::soft_cotton()};
}

WindSettings steady(double speed, double direction = 0.0) {
    WindSettings wind;
    wind.speed = speed;
    wind.direction = direction;
    wind.gusts = 0.0;
    return wind;
}

constexpr double dt = 1.0 / 30.0;

}  // namespace

TEST(ViewerWind, AFlatPlateFeelsHalfTheAirsDensityTimesTheSpeedSquared) {
    const Garment sheet = upright_sheet();
    const Points a = wind_accelerations(steady(3.0), sheet, ClothState::at_rest(sheet), dt);
    const double rate = 0.5 * 1.2 / sheet.fabric().density * 3.0;
    const double expected = rate * 3.0 / (1.0 + rate * dt);
    ASSERT_EQ(a.rows(), sheet.vertex_count());
    for (Eigen::Index i = 0; i < a.rows(); ++i)
        EXPECT_NEAR((a.row(i) - Eigen::RowVector3d(0, 0, expected)).norm(), 0.0, 1e-9) << i;
}

TEST(ViewerWind, BlowsAlongAFaceWithoutAForce) {
    const Garment sheet = upright_sheet();
    const Points a = wind_accelerations(steady(3.0, 90.0), sheet, ClothState::at_rest(sheet), dt);
    EXPECT_NEAR(a.norm(), 0.0, 1e-9);
}

TEST(ViewerWind, NeverTakesClothBeyondTheSpeedOfTheAir) {
    const Garment sheet = upright_sheet().with_fabric({0.01, 11.1, 20.9, 3.96e-5});
    ClothState state = ClothState::at_rest(sheet);
    double before = 0.0;
    for (int step = 0; step < 100; ++step) {
        state.v += dt * wind_accelerations(steady(20.0), sheet, state, dt);
        EXPECT_GT(state.v(0, 2), before);
        EXPECT_LT(state.v.col(2).maxCoeff(), 20.0);
        before = state.v(0, 2);
    }
    EXPECT_GT(before, 19.0);
}

TEST(ViewerWind, WithoutSpeedThereIsNoAir) {
    const Garment sheet = upright_sheet();
    EXPECT_EQ(wind_accelerations({}, sheet, ClothState::at_rest(sheet), dt).rows(), 0);
}

TEST(ViewerWind, GustsSwingAboutTheMeanAndAreTheSameAgain) {
    WindSettings wind = steady(10.0, 30.0);
    wind.gusts = 1.0;
    double sum = 0.0, lowest = 1e9, highest = 0.0;
    const int count = 10000;
    for (int k = 0; k < count; ++k) {
        const Vec3 velocity = wind_velocity(wind, 0.01 * k);
        EXPECT_EQ(velocity, wind_velocity(wind, 0.01 * k));
        EXPECT_NEAR(std::abs(velocity.x()), std::abs(velocity.z()) * std::tan(M_PI / 6.0), 1e-9);
        sum += velocity.norm();
        lowest = std::min(lowest, velocity.norm());
        highest = std::max(highest, velocity.norm());
    }
    EXPECT_NEAR(sum / count, 10.0, 0.2);
    EXPECT_LT(lowest, 2.0);
    EXPECT_GT(highest, 18.0);
}

TEST(ViewerWind, SettingsOutOfRangeAreRefusedByName) {
    const auto refusal = [](const WindSettings& wind) -> std::string {
        try {
            check(wind);
        } catch (const ArgumentError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(refusal(steady(20.0)), "");
    EXPECT_NE(refusal(steady(21.0)).find("WindSettings.speed"), std::string::npos);
    EXPECT_NE(refusal(steady(std::nan(""))).find("WindSettings.speed"), std::string::npos);
    EXPECT_NE(refusal(steady(1.0, 400.0)).find("WindSettings.direction"), std::string::npos);
    WindSettings wind = steady(1.0);
    wind.gusts = -0.1;
    EXPECT_NE(refusal(wind).find("WindSettings.gusts"), std::string::npos);
}

}  // namespace cloth::viewer_wind_test
