#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/bulletClothStepper.h"
#include "bullet_ext/garmentSoftBody.h"
#include "data/authoring/sheet.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

TEST(SettingsRanges, GnnSolver) {
    using S = btGnnSolverSettings;
    const auto use = [](const S& settings) {
        btGnnSoftBodySolver([](const Garment&) { return nullptr; }, settings);
    };
    expect_range("btGnnSolverSettings.obstacleReach", &S::obstacleReach, 0.02, 1.0, use);
    expect_range("btGnnSolverSettings.sleepMotion", &S::sleepMotion, 0.0, 0.05, use);
    expect_range("btGnnSolverSettings.layerThickness", &S::layerThickness, 1e-3, 2e-2, use);
    S off;
    off.layerThickness = 0.0;
    use(off);
    expect_range("btGnnSolverSettings.maxFailedSteps", &S::maxFailedSteps, 1, 1000000, use);
}

TEST(SettingsRanges, SoftBody) {
    using S = SoftBodySettings;
    const auto use = [](const S& settings) { checkSoftBodySettings(settings); };
    expect_range("SoftBodySettings.iterations", &S::iterations, 1, 1000, use);
    expect_range("SoftBodySettings.margin", &S::margin, 1e-4, 0.25, use);
    expect_range("SoftBodySettings.stiffness", &S::stiffness, 0.0, 1.0, use);
    expect_range("SoftBodySettings.bending", &S::bending, 0.0, 1.0, use);
    expect_range("SoftBodySettings.friction", &S::friction, 0.0, 1.0, use);
    expect_range("SoftBodySettings.contact_hardness", &S::contact_hardness, 0.0, 1.0, use);
}

TEST(SettingsRanges, BulletCloth) {
    using S = BulletClothSettings;
    const Garment sheet("sheet", make_sheet(1.0, 1.0, 20), Fabric::soft_cotton(), {});
    const auto use = [&](const S& settings) { BulletClothStepper(sheet, settings); };
    expect_range("BulletClothSettings.substep_dt", &S::substep_dt, 1e-4, 0.1, use);
    expect_range("BulletClothSettings.voxel", &S::voxel, 1e-3, 0.25, use);
    expect_range("BulletClothSettings.hull_margin", &S::hull_margin, 0.0, 0.05, use);
    expect_range("BulletClothSettings.segments", &S::segments, 1, 1000, use);
    expect_range("SoftBodySettings.margin", 1e-4, 0.25, [&](double value) {
        BulletClothSettings settings;
        settings.cloth.margin = value;
        use(settings);
    });
}

}  // namespace
}  // namespace cloth::test
