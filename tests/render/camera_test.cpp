#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/core/errors.h"

namespace cloth::test {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 720;
constexpr double kAspect = double(kWidth) / kHeight;

/// A standing figure: the corners of a box of 1.0 x 1.7 x 0.4 m on the floor at (x, 0, z).
Points figure_at(double x, double y, double z, double arm_span = 1.0) {
    Points corners(8, 3);
    for (int i = 0; i < 8; ++i)
        corners.row(i) << x + arm_span * ((i & 1) - 0.5), y + 1.7 * ((i >> 1) & 1),
            z + 0.4 * ((i >> 2) - 0.5);
    return corners;
}

/// Smallest distance of a point to the border, as a part of the picture's side.
double border_of(const Camera& camera, const Points& figure) {
    double border = 1.0;
    for (int i = 0; i < figure.rows(); ++i) {
        const PixelPosition p = project(camera, figure.row(i), kWidth, kHeight);
        border =
            std::min({border, p.x / kWidth, 1 - p.x / kWidth, p.y / kHeight, 1 - p.y / kHeight});
    }
    return border;
}

TEST(Camera, ProjectsKnownPoints) {
    Camera camera;
    camera.eye = Vec3(0, 1, 4);
    camera.target = Vec3(0, 1, 0);
    camera.fov_y_deg = 90.0;
    const PixelPosition middle = project(camera, Vec3(0, 1, 0), 200, 100);
    EXPECT_NEAR(middle.x, 100.0, 1e-9);
    EXPECT_NEAR(middle.y, 50.0, 1e-9);
    EXPECT_NEAR(middle.distance, 4.0, 1e-9);
    // With 90 degrees the picture's top edge at distance 4 is 4 m above its middle.
    const PixelPosition corner = project(camera, Vec3(8, 5, 0), 200, 100);
    EXPECT_NEAR(corner.x, 200.0, 1e-9);
    EXPECT_NEAR(corner.y, 0.0, 1e-9);
    EXPECT_LT(project(camera, Vec3(0, 1, 9), 200, 100).distance, 0.0);
}

TEST(Camera, DepthRunsFromMinusOneToOneBetweenThePlanes) {
    const Camera camera;
    const Eigen::Matrix4d matrix = projection_matrix(camera, 1.0);
    const auto depth = [&](double distance) {
        const Eigen::Vector4d clip = matrix * Eigen::Vector4d(0, 0, -distance, 1);
        return clip.z() / clip.w();
    };
    EXPECT_NEAR(depth(camera.near_plane), -1.0, 1e-12);
    EXPECT_NEAR(depth(camera.far_plane), 1.0, 1e-12);
}

TEST(Camera, UnusableCamerasAreRefused) {
    Camera camera;
    camera.target = camera.eye;
    EXPECT_THROW(view_matrix(camera), ArgumentError);
    camera.target = camera.eye + Vec3(0, 2, 0);
    EXPECT_THROW(view_matrix(camera), ArgumentError);
    camera.target.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(view_matrix(camera), ArgumentError);
    Camera wide;
    wide.fov_y_deg = 180.0;
    EXPECT_THROW(projection_matrix(wide, 1.0), ArgumentError);
    wide = Camera();
    wide.far_plane = wide.near_plane;
    EXPECT_THROW(projection_matrix(wide, 1.0), ArgumentError);
    EXPECT_THROW(projection_matrix(Camera(), 0.0), ArgumentError);
}

TEST(FigureTracker, FirstFrameFillsThePictureAroundTheFigure) {
    const FramingSettings settings;
    FigureTracker tracker(settings, kAspect);
    const Points figure = figure_at(3, 0, -2);
    const double border = border_of(tracker.follow(figure), figure);
    EXPECT_GE(border, settings.margin);
    EXPECT_LE(border, settings.margin + settings.dead_zone + 0.08) << "the figure is too small";
}

TEST(FigureTracker, WalkingTurningAndJumpingFiguresStayInsideTheMargin) {
    const FramingSettings settings;
    FigureTracker tracker(settings, kAspect);
    for (int frame = 0; frame < 240; ++frame) {
        const double t = frame / 30.0;
        const Points figure = figure_at(2.5 * t, 0.6 * std::max(0.0, std::sin(3 * t)),
                                        4 * std::sin(0.7 * t), 1.0 + 0.4 * std::sin(2 * t));
        EXPECT_GE(border_of(tracker.follow(figure), figure), settings.margin - 1e-9)
            << "frame " << frame;
    }
}

TEST(FigureTracker, SmallMovementsDoNotMoveTheCamera) {
    FigureTracker tracker(FramingSettings{}, kAspect);
    const Camera first = tracker.follow(figure_at(0, 0, 0));
    for (int frame = 0; frame < 60; ++frame) {
        const Camera camera =
            tracker.follow(figure_at(0.03 * std::sin(frame), 0.04 * std::cos(frame), 0));
        EXPECT_LT((camera.eye - first.eye).norm(), 1e-12) << "the picture shakes in " << frame;
        EXPECT_LT((camera.target - first.target).norm(), 1e-12);
    }
}

TEST(FigureTracker, StartsAndStopsWithoutAJerk) {
    FigureTracker tracker(FramingSettings{}, kAspect);
    Vec3 before = tracker.follow(figure_at(0, 0, 0)).target;
    Vec3 velocity = Vec3::Zero();
    const double step = 1.4 / 30.0;  // a brisk walk (m per frame)
    for (int frame = 1; frame < 90; ++frame) {
        const double x = step * std::min(frame, 60);
        const Vec3 target = tracker.follow(figure_at(x, 0, 0)).target;
        EXPECT_LE((target - before - velocity).norm(), 0.5 * step) << "frame " << frame;
        velocity = target - before;
        before = target;
    }
}

TEST(FigureTracker, OnlyMovesBackNeverForth) {
    FigureTracker tracker(FramingSettings{}, kAspect);
    const auto distance = [](const Camera& camera) { return (camera.eye - camera.target).norm(); };
    const double narrow = distance(tracker.follow(figure_at(0, 0, 0, 1.0)));
    const double wide = distance(tracker.follow(figure_at(0, 0, 0, 3.0)));
    EXPECT_GT(wide, narrow);
    EXPECT_DOUBLE_EQ(distance(tracker.follow(figure_at(0, 0, 0, 1.0))), wide);
}

TEST(FigureTracker, IgnoresPointsThatAreNotFinite) {
    const Points figure = figure_at(0, 0, 0);
    Points broken(9, 3);
    broken << figure, Eigen::RowVector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    FigureTracker clean(FramingSettings{}, kAspect), tracker(FramingSettings{}, kAspect);
    EXPECT_EQ(tracker.follow(broken).eye, clean.follow(figure).eye);
    EXPECT_THROW(tracker.follow(Points(0, 3)), ArgumentError);
    EXPECT_THROW(tracker.follow(broken.bottomRows(1)), ArgumentError);
}

TEST(FigureTracker, SettingsOutOfRangeAreRefused) {
    FramingSettings settings;
    settings.margin = 0.5;
    EXPECT_THROW(FigureTracker(settings, kAspect), ArgumentError);
    settings = FramingSettings();
    settings.direction = settings.up;
    EXPECT_THROW(FigureTracker(settings, kAspect), ArgumentError);
    settings = FramingSettings();
    settings.smoothing = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(FigureTracker(settings, kAspect), ArgumentError);
    EXPECT_THROW(FigureTracker(FramingSettings(), -1.0), ArgumentError);
}

}  // namespace
}  // namespace cloth::test
