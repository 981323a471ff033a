// Coulomb's law between layers: a sheet on a sheet that is held lies still below the friction angle
// and slides above it.

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "gnn/physics/stepper/cloth_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/gnn/physics/stepper/self_contact_scenes.h"

namespace cloth::layer_friction_scenes_test {
namespace {

constexpr double coefficient = 0.4;  // friction angle 21.8 degrees
constexpr double degree = M_PI / 180.0;

SelfContactSettings contact_settings(double friction) {
    SelfContactSettings settings;
    settings.thickness = 4e-3;
    settings.friction = friction;
    return settings;
}

struct Case {
    std::string name;
    std::function<std::unique_ptr<Stepper>(const Garment&, double friction)> make;
};

void PrintTo(const Case& one, std::ostream* out) {
    *out << one.name;
}

class SheetOnSheet : public ::testing::TestWithParam<Case> {
 protected:
    /// How far (m) the upper sheet slides in a second, if gravity leans by `angle`.
    static double slide(double angle, double friction, int steps) {
        const double dt = 1.0 / steps;
        TriMesh above = make_sheet(0.2, 0.2, 120, 3);
        above.vertices.col(1).array() += 3.99e-3;
        const Garment below("below", make_sheet(3.0, 0.4, 900), Fabric::soft_cotton());
        std::vector<int> pins;
        for (int i = 0; i < static_cast<int>(below.vertex_count()); ++i) pins.push_back(i);
        const Garment garment =
            merge_garments("layers",
                           {below.with_pins(pins), Garment("above", above, Fabric::soft_cotton())})
                .garment;
        const Eigen::Index upper = above.vertices.rows();
        ClothState state = ClothState::at_rest(garment);
        Boundary boundary;
        boundary.pin_targets = below.rest().vertices;
        boundary.gravity = 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0);
        const auto stepper = GetParam().make(garment, friction);
        for (int step = 0; step < steps; ++step) {
            const StepReport report = stepper->step(boundary, dt, state);
            EXPECT_TRUE(report.finite) << "step " << step;
            EXPECT_EQ(report.tangles, 0) << "step " << step;
        }
        return (state.x - garment.rest().vertices).bottomRows(upper).col(0).mean();
    }
};

TEST_P(SheetOnSheet, HoldsBelowTheFrictionAngle) {
    // What friction between layers holds creeps, by 3 mm/s at most.
    EXPECT_LT(std::abs(slide(10 * degree, coefficient, 60)), 3e-3);
}

/// How far backward Euler slides in a second of steps from rest (m).
double expected_slide(double acceleration, int steps) {
    return 0.5 * acceleration * (1.0 + 1.0 / steps);
}

TEST_P(SheetOnSheet, SlidesAboveItAsCoulombSays) {
    // In longer steps the sheet passes several edges in each, while its pressure is that of before.
    const int steps = 240;
    for (const double angle : {26 * degree, 35 * degree}) {
        const double expected =
            expected_slide(9.81 * (std::sin(angle) - coefficient * std::cos(angle)), steps);
        EXPECT_NEAR(slide(angle, coefficient, steps), expected, 0.15 * expected);
    }
}

TEST_P(SheetOnSheet, LayersWithoutFrictionSlideFreely) {
    const double angle = 12 * degree;
    const double expected = expected_slide(9.81 * std::sin(angle), 60);
    EXPECT_NEAR(slide(angle, 0.0, 60), expected, 0.15 * expected);
}

std::unique_ptr<Stepper> quasi_newton(const Garment& garment, double friction) {
    ClothStepperSettings settings;
    settings.step.potential.self_contact = contact_settings(friction);
    return std::make_unique<ClothStepper>(garment, settings);
}

std::unique_ptr<Stepper> xpbd(const Garment& garment, double friction) {
    XpbdSettings settings;
    settings.self_contact = contact_settings(friction);
    return std::make_unique<XpbdStepper>(garment, settings);
}

INSTANTIATE_TEST_SUITE_P(Steppers, SheetOnSheet,
                         ::testing::Values(Case{"QuasiNewton", quasi_newton}, Case{"Xpbd", xpbd}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace cloth::layer_friction_scenes_test
