#include "gnn/physics/energy/friction.h"

#include <limits>
#include <random>

#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::friction_test {

using namespace cloth::test;

namespace {

const double pi = std::acos(-1.0);

class FrictionTest : public ::testing::Test {
 protected:
    Garment garment{"sheet", sheet(5, 0.2), Fabric::soft_cotton()};
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    FrictionSettings settings;
    FrictionEnergy friction;

    FrictionTest() {
        boundary.obstacles.resize(1);
        boundary.obstacles[0].shape = ObstacleShape::plane;
        boundary.obstacles[0].friction = 0.4;
        settings.contact_distance = 4e-3;
        settings.contact_weight = 5e5;
    }
    /// The sheet 5 mm above a plane that moves by `motion` in the step.
    void begin(const Vec3& normal, const Vec3& motion = Vec3::Zero(), double height = 5e-3) {
        SurfaceContacts contacts = plane_contacts(state.x, Vec3::Zero(), normal, motion);
        contacts.distance.setConstant(height);
        friction.begin_step(garment, state, boundary, contacts, settings);
    }
    void gradient(const Points& x, Points& out) const {
        out.setZero(x.rows(), 3);
        friction.add_gradient(x, out);
    }
    double weight() const { return garment.masses().sum() * 9.81; }
    /// A step ends with the sheet pushed along by `slip`, and the next one begins there.
    void push(const Vec3& slip) {
        state.x.rowwise() += slip.transpose();
        friction.remember(state.x, state.stick);
    }
    double force_at_start() const {
        Points g;
        gradient(state.x, g);
        return g.colwise().sum().norm();
    }
};

}  // namespace

TEST_F(FrictionTest, LongSlipCostsCoulombForceTimesWay) {
    begin(Vec3::UnitY());
    const double way = 0.5;
    const Points x = state.x.rowwise() + Eigen::RowVector3d(way, 0.3, 0);
    // The smoothing costs at most `slip` of the way.
    EXPECT_NEAR(friction.value(x), 0.4 * weight() * way, 0.4 * weight() * 1.01 * settings.slip);
}

TEST_F(FrictionTest, OnAnInclineTheNormalForceIsTheCosinePart) {
    const double angle = pi / 6.0;
    begin(Vec3(std::sin(angle), std::cos(angle), 0));
    Points g;
    gradient(state.x.rowwise() + Eigen::RowVector3d(0, 0, 0.1), g);
    EXPECT_NEAR(g.col(2).sum(), 0.4 * weight() * std::cos(angle), 1e-5 * weight());
}

TEST_F(FrictionTest, ClothThatMovesWithTheSurfaceFeelsNothing) {
    const Vec3 motion(0.1, 0.02, -0.05);
    begin(Vec3::UnitY(), motion);
    const Points x = state.x.rowwise() + motion.transpose();
    Points g;
    gradient(x, g);
    EXPECT_NEAR(friction.value(x), 0.0, 1e-15);
    EXPECT_LT(g.norm(), 1e-12);
    EXPECT_GT(friction.value(state.x), 0.0);
}

TEST_F(FrictionTest, ClothThatTurnsWithTheSurfaceBelowItFeelsNothing) {
    // A flat side of a body that turns about an axis 5 mm above it, in the cloth.
    const double height = 5e-3;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.1, Vec3::UnitX()).toRotationMatrix();
    SurfaceContacts contacts =
        plane_contacts(state.x, Vec3(0, -height, 0), Vec3::UnitY(), Vec3::Zero());
    contacts.point1 = contacts.point0 * turn.transpose();
    contacts.normal1 = contacts.normal0 * turn.transpose();
    friction.begin_step(garment, state, boundary, contacts, settings);
    ASSERT_EQ(friction.sliders().size(), static_cast<size_t>(state.x.rows()));
    EXPECT_NEAR(friction.value(state.x * turn.transpose()), 0.0, 1e-12);
}

TEST_F(FrictionTest, FollowsGravityNotAnAxis) {
    boundary.gravity = Vec3(0, 0, -9.81);
    begin(Vec3::UnitZ());
    Points g;
    gradient(state.x.rowwise() + Eigen::RowVector3d(0.1, 0, 0), g);
    EXPECT_NEAR(g.col(0).sum(), 0.4 * weight(), 1e-5 * weight());
}

TEST_F(FrictionTest, ACeilingCarriesNoWeight) {
    begin(-Vec3::UnitY());
    EXPECT_EQ(friction.value(state.x.rowwise() + Eigen::RowVector3d(0.1, 0, 0)), 0.0);
}

TEST_F(FrictionTest, SkinsHoldWhatTheyPinchByTheirPressureOnItsArea) {
    boundary.pinched.assign(static_cast<size_t>(state.x.rows()), 0);
    boundary.pinched[7] = 1;
    settings.pinch_pressure = 400.0;
    begin(Vec3::UnitZ());
    Points g;
    gradient(state.x.rowwise() + Eigen::RowVector3d(0.1, 0.0, 0.0), g);
    const double area = garment.masses()[7] / garment.fabric().density;
    EXPECT_NEAR(g(7, 0), 0.4 * 400.0 * area, 1e-4 * 400.0 * area);
    EXPECT_EQ(friction.sliders().size(), 1u) << "a wall carries no weight";
}

TEST_F(FrictionTest, PressureHoldsOnAVerticalWallUpToTheLimit) {
    const Points slid = state.x.rowwise() + Eigen::RowVector3d(0, 0.1, 0);
    begin(Vec3::UnitZ());
    EXPECT_EQ(friction.value(slid), 0.0);
    const double depth = 5e-6;
    begin(Vec3::UnitZ(), Vec3::Zero(), settings.contact_distance - depth);
    Points g;
    gradient(slid, g);
    const double pressed = 3.0 * settings.contact_weight * depth * depth;
    const double count = static_cast<double>(state.x.rows());
    EXPECT_NEAR(g.col(1).sum(), 0.4 * count * pressed, 1e-5 * count * pressed);
    begin(Vec3::UnitZ(), Vec3::Zero(), 0.0);
    gradient(slid, g);
    EXPECT_NEAR(g.col(1).sum(), 0.4 * settings.pressure_limit * weight(), 1e-4 * weight());
}

TEST_F(FrictionTest, PressureHoldsAsMuchWithoutGravity) {
    const double depth = 5e-6, count = static_cast<double>(state.x.rows());
    const double pressed = 0.4 * count * 3.0 * settings.contact_weight * depth * depth;
    for (const double gravity : {9.81, 1.62, 0.0}) {
        boundary.gravity = Vec3(0, -gravity, 0);
        begin(Vec3::UnitZ(), Vec3::Zero(), settings.contact_distance - depth);
        Points g;
        gradient(state.x.rowwise() + Eigen::RowVector3d(0, 0.1, 0), g);
        EXPECT_NEAR(g.col(1).sum(), pressed, 1e-5 * pressed) << gravity;
    }
}

TEST_F(FrictionTest, ThePressuresLimitGrowsWithGravityOnly) {
    EXPECT_EQ(limiting_acceleration(Vec3(0, -9.81, 0)), 9.81);
    EXPECT_EQ(limiting_acceleration(Vec3(0, 0, 25.0)), 25.0);
    EXPECT_EQ(limiting_acceleration(Vec3(0, -1.62, 0)), limiting_acceleration(Vec3::Zero()));
    EXPECT_NEAR(limiting_acceleration(Vec3::Zero()), 9.81, 0.01);
}

TEST_F(FrictionTest, TheNextStepHoldsAsTheLastOneDid) {
    const Vec3 slip = 2.0 * settings.slip * Vec3::UnitX();
    const double force = 0.4 * weight() * 2.0 / std::sqrt(5.0);
    begin(Vec3::UnitY());
    push(slip);
    EXPECT_NEAR(force_at_start(), force, 1e-9 * weight());
    for (int step = 0; step < 100; ++step) {  // nothing moves: nothing is forgotten
        begin(Vec3::UnitY());
        EXPECT_NEAR(force_at_start(), force, 1e-9 * weight());
        push(Vec3::Zero());
    }
    settings.distance = 4e-3;  // off the surface all is forgotten
    begin(Vec3::UnitY());
    push(Vec3::Zero());
    settings.distance = 6e-3;
    begin(Vec3::UnitY());
    EXPECT_EQ(force_at_start(), 0.0);
}

TEST_F(FrictionTest, ALongSlipIsForgottenButForWhatHolds) {
    begin(Vec3::UnitY());
    push(0.1 * Vec3::UnitZ());
    begin(Vec3::UnitY());
    const double kept = 3.0 / std::sqrt(10.0);
    EXPECT_NEAR(force_at_start(), kept * 0.4 * weight(), 1e-6 * weight());
}

TEST_F(FrictionTest, WhatItStoresNeverGrowsByItself) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    begin(Vec3::UnitY());
    for (int step = 0; step < 300; ++step) {
        push(4e-4 * (noise(1, 1.0, static_cast<unsigned>(step)).row(0).transpose()));
        const double before = friction.value(state.x);
        // Other pressure, smoothing, normal and friction.
        boundary.obstacles[0].friction = 1.5 * part(random);
        settings.slip = std::pow(10.0, -5.0 + 2.0 * part(random));
        const Vec3 normal(part(random) - 0.5, 1.0, part(random) - 0.5);
        begin(normal.normalized(), Vec3::Zero(), 6e-3 * part(random));
        EXPECT_LE(friction.value(state.x), before * (1.0 + 1e-9)) << "step " << step;
    }
}

TEST_F(FrictionTest, AMemoryThatDoesNotFitCountsForNothing) {
    begin(Vec3::UnitY());
    push(settings.slip * Vec3::UnitX());
    const StickMemory good = state.stick;
    state.stick.slip.conservativeResize(3, 3);
    begin(Vec3::UnitY());
    Points g;
    gradient(state.x, g);
    EXPECT_GT(g.topRows(3).norm(), 0.0);
    EXPECT_EQ(g.bottomRows(g.rows() - 3).norm(), 0.0);
    state.stick = good;
    state.stick.slip.setConstant(std::numeric_limits<double>::quiet_NaN());
    begin(Vec3::UnitY());
    EXPECT_EQ(force_at_start(), 0.0);
}

TEST_F(FrictionTest, ActsOnlyNearTheSurface) {
    begin(Vec3::UnitY(), Vec3::Zero(), 7e-3);
    EXPECT_EQ(friction.value(state.x.rowwise() + Eigen::RowVector3d(0.1, 0, 0)), 0.0);
}

TEST_F(FrictionTest, GradientEqualsFiniteDifferencesOnBothSidesOfTheSmoothing) {
    begin(Vec3(0.3, 1.0, 0.2).normalized(), Vec3(0.01, 0, 0));
    for (double size : {3e-5, 1e-2}) {
        const Points x =
            (state.x.rowwise() + Eigen::RowVector3d(0.01, 0, 0)) + noise(state.x.rows(), size, 2);
        expect_gradient([&](const Points& y) { return friction.value(y); },
                        [&](const Points& y, Points& g) { gradient(y, g); }, x, 1e-6, 2e-6);
    }
}

TEST_F(FrictionTest, HessianEqualsFiniteDifferences) {
    begin(Vec3(0.3, 1.0, 0.2).normalized());
    const BlockPattern pattern(garment);
    const Points x = state.x + noise(state.x.rows(), 2e-4, 2);
    const Points direction = noise(x.rows(), 1.0, 9);
    Eigen::SparseMatrix<double> hessian;
    pattern.reset(hessian);
    friction.add_hessian(x, pattern, hessian.valuePtr());
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    const Points numeric = numeric_hessian_product(
        [&](const Points& y, Points& g) { gradient(y, g); }, x, direction, 1e-6);
    expect_close(product, numeric, 1e-6);
}

}  // namespace cloth::friction_test
