// Coulomb's law for what users run: a sheet lies still on an incline below the friction angle and
// slides above it.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "data/authoring/sheet.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

namespace cloth::incline_test {
namespace {

constexpr double dt = 1.0 / 30.0;
constexpr double friction = 0.5;  // friction angle 26.6 degrees
constexpr double degree = M_PI / 180.0;

struct Case {
    std::string name;
    std::function<std::unique_ptr<Stepper>(const Garment&)> make;
};

void PrintTo(const Case& one, std::ostream* out) {
    *out << one.name;
}

/// A plane through the origin that falls by `angle` towards +x.
Obstacle incline(double angle) {
    Obstacle plane;
    plane.shape = ObstacleShape::plane;
    plane.pose0.rotate(Eigen::AngleAxisd(-angle, Vec3::UnitZ()));
    plane.pose1 = plane.pose0;
    plane.friction = friction;
    return plane;
}

/// How far (m) a sheet's middle slides down in two seconds.
double slide(const std::function<std::unique_ptr<Stepper>(const Garment&)>& make, double angle) {
    TriMesh mesh = make_sheet(0.2, 0.2, 120);
    const Eigen::AngleAxisd tilt(-angle, Vec3::UnitZ());
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        const Vec3 flat = mesh.vertices.row(i);
        mesh.vertices.row(i) = (tilt * (flat + 3.99e-3 * Vec3::UnitY())).transpose();
    }
    const Garment garment("sheet", mesh, Fabric::soft_cotton(), {});
    const auto stepper = make(garment);
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    boundary.obstacles = {incline(angle)};
    for (int frame = 0; frame < 60; ++frame) {
        const StepReport report = stepper->step(boundary, dt, state);
        EXPECT_TRUE(report.finite) << "frame " << frame;
        EXPECT_LT(report.max_penetration, 1e-3) << "frame " << frame;
    }
    return ((state.x - mesh.vertices) * (tilt * Vec3::UnitX())).mean();
}

/// Of backward Euler in steps of h, which slides one step's worth ahead.
double way_by_coulomb(double angle, double h) {
    const double acceleration = 9.81 * (std::sin(angle) - friction * std::cos(angle));
    return 0.5 * acceleration * 2.0 * (2.0 + h);
}

class Incline : public ::testing::TestWithParam<Case> {
 protected:
    static double slide(double angle) { return incline_test::slide(GetParam().make, angle); }
};

TEST_P(Incline, HoldsBelowTheFrictionAngle) {
    EXPECT_LT(std::abs(slide(15 * degree)), 1e-3);
    EXPECT_LT(std::abs(slide(20 * degree)), 1e-3);
}

TEST_P(Incline, SlidesAboveItAsCoulombSays) {
    for (const double angle : {32 * degree, 45 * degree}) {
        const double expected = way_by_coulomb(angle, dt);
        EXPECT_NEAR(slide(angle), expected, 0.15 * expected);
    }
}

TEST(InclineInSmallSteps, SlidesWithinTwoHundredthsWithFewIterations) {
    for (const int iterations : {3, 10}) {
        SCOPED_TRACE(iterations);
        const auto make = [=](const Garment& garment) {
            ClothStepperSettings settings;
            settings.step = StepSettings::in_small_steps(120.0, iterations);
            return std::make_unique<ClothStepper>(garment, settings);
        };
        for (const double angle : {32 * degree, 45 * degree}) {
            const double expected = way_by_coulomb(angle, dt / 4.0);
            EXPECT_NEAR(slide(make, angle), expected, 0.02 * expected);
        }
    }
}

std::unique_ptr<Stepper> solver(const Garment& garment) {
    return std::make_unique<ClothStepper>(garment, ClothStepperSettings::plain());
}

std::unique_ptr<Stepper> small_steps(const Garment& garment) {
    return make_cloth(garment);
}

std::unique_ptr<Stepper> learned(const Garment& garment) {
    ClothSettings settings;
    settings.weights = std::make_shared<const EngineWeights>(
        Weights::load(asset_path("weights/small.safetensors")));
    return make_cloth(garment, settings);
}

INSTANTIATE_TEST_SUITE_P(Steppers, Incline,
                         ::testing::Values(Case{"QuasiNewton", solver},
                                           Case{"SmallSteps", small_steps},
                                           Case{"Learned", learned}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace cloth::incline_test
