#include "demos/viewer/orbit_camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cloth::viewer_camera_test {

namespace {

constexpr int width = 800, height = 600;
constexpr double aspect = 800.0 / 600.0;

Points figure() {
    Points points(4, 3);
    points << -0.4, 0, -0.2, 0.4, 1.8, 0.2, 0.1, 0.9, 0.3, -0.3, 0.2, 0.0;
    return points;
}

PixelPosition pixel_of(const Camera& camera, const Vec3& point) {
    return project(camera, point, width, height);
}

}  // namespace

TEST(ViewerCamera, FramesTheWholeFigure) {
    for (const double share : {1.0, 0.6}) {
        OrbitCamera orbit;
        orbit.frame(figure(), aspect * share);
        const Camera camera = orbit.camera(0.5 * (1.0 - share), aspect);
        const Points points = figure();
        for (Eigen::Index i = 0; i < points.rows(); ++i) {
            const PixelPosition pixel = pixel_of(camera, points.row(i).transpose());
            EXPECT_GT(pixel.x, (1.0 - share) * width);
            EXPECT_LT(pixel.x, width);
            EXPECT_GT(pixel.y, 0.0);
            EXPECT_LT(pixel.y, height);
            EXPECT_GT(pixel.distance, 0.0);
        }
    }
}

TEST(ViewerCamera, TheTargetIsInTheMiddleOfWhatThePanelLeaves) {
    OrbitCamera orbit;
    orbit.frame(figure(), aspect);
    const PixelPosition pixel = pixel_of(orbit.camera(0.125, aspect), orbit.target());
    EXPECT_NEAR(pixel.x, width * (0.5 + 0.125), 1e-6);
    EXPECT_NEAR(pixel.y, 0.5 * height, 1e-6);
}

TEST(ViewerCamera, AHeightOfThePictureIsHalfATurn) {
    OrbitCamera orbit;
    const Vec3 before = orbit.camera().eye - orbit.target();
    orbit.orbit(1.0, 0.0);
    const Vec3 after = orbit.camera().eye - orbit.target();
    EXPECT_NEAR(after.norm(), before.norm(), 1e-12);
    EXPECT_NEAR(after.y(), before.y(), 1e-12);
    EXPECT_NEAR(after.x(), -before.x(), 1e-9);
    EXPECT_NEAR(after.z(), -before.z(), 1e-9);
}

TEST(ViewerCamera, StopsBeforeThePoles) {
    OrbitCamera orbit;
    for (const double way : {10.0, -20.0}) {
        orbit.orbit(0.0, way);
        const Camera camera = orbit.camera();
        EXPECT_NO_THROW(view_matrix(camera));
        EXPECT_GT((camera.eye - orbit.target()).y() * way, 0.0);
    }
}

TEST(ViewerCamera, WhatIsAtTheTargetsDepthStaysUnderTheMouse) {
    OrbitCamera orbit;
    orbit.orbit(0.3, -0.1);
    const Vec3 point = orbit.target();
    const PixelPosition before = pixel_of(orbit.camera(), point);
    orbit.pan(0.2, 0.1);
    const PixelPosition after = pixel_of(orbit.camera(), point);
    EXPECT_NEAR(after.x - before.x, 0.2 * height, 1e-6);
    EXPECT_NEAR(after.y - before.y, 0.1 * height, 1e-6);
}

TEST(ViewerCamera, TheWheelBringsItNearerWithinLimits) {
    OrbitCamera orbit;
    const double before = orbit.distance();
    orbit.zoom(1.0);
    EXPECT_LT(orbit.distance(), before);
    orbit.zoom(1000.0);
    EXPECT_NEAR(orbit.distance(), 0.2, 1e-12);
    orbit.zoom(-1000.0);
    EXPECT_NEAR(orbit.distance(), 50.0, 1e-12);
    EXPECT_NO_THROW(projection_matrix(orbit.camera(), aspect));
}

}  // namespace cloth::viewer_camera_test
