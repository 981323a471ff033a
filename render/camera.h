#pragma once

#include <Eigen/Core>

#include "data/core/types.h"

namespace cloth {

/// A pinhole camera that looks from `eye` to `target`.
struct Camera {
    Vec3 eye = Vec3(0, 1, 4);     ///< (m)
    Vec3 target = Vec3(0, 1, 0);  ///< (m), any point other than `eye`
    Vec3 up = Vec3(0, 1, 0);      ///< what shall point up in the picture; not along the view
    double fov_y_deg = 30.0;      ///< vertical field of view (degrees), 5 to 120
    double near_plane = 0.1;      ///< nearest visible distance (m), 1e-6 to 1e6
    double far_plane = 100.0;     ///< farthest visible distance (m), 1.001 near_plane to 1e9
};

/// Where a point appears: pixels from the top left corner of the picture (pixel centres at .5).
struct PixelPosition {
    double x = 0.0;
    double y = 0.0;
    double distance = 0.0;  ///< along the view direction (m); behind the camera when negative
};

/// World to camera space (x right, y up, looking along -z), 4 x 4.
/// @throws ArgumentError if eye and target coincide, `up` is along the view or a number is unusable
Eigen::Matrix4d view_matrix(const Camera& camera);

/// Camera space to OpenGL's clip space, 4 x 4. @param aspect  width / height of the picture
Eigen::Matrix4d projection_matrix(const Camera& camera, double aspect);

/// Where `point` (m) appears in a picture of width x height pixels.
PixelPosition project(const Camera& camera, const Vec3& point, int width, int height);

/// How FigureTracker frames a figure.
struct FramingSettings {
    Vec3 direction = Vec3(-0.35, -0.12, -1.0);  ///< the view direction, any length
    Vec3 up = Vec3(0, 1, 0);
    double fov_y_deg = 30.0;  ///< (degrees), 5 to 120; small flattens the perspective
    double margin = 0.06;     ///< border that stays free, as a part of the picture, 0 to 0.2
    double dead_zone = 0.05;  ///< how far the figure's middle may leave the picture's before the
                              ///< camera moves, as a part of the picture, 0 to 0.2
    double smoothing = 0.15;  ///< part of the missing way that the camera makes per frame, 0 to 1;
                              ///< small is smooth, but the figure leans out of the middle
};

/// Keeps a moving figure in frame with a steady hand.
///
///     FigureTracker tracker(FramingSettings{}, 640.0 / 720.0);
///     for (const Points& body : frames) image = renderer.render(scene, tracker.follow(body));
///
/// The view direction never changes. The camera slides sideways and up only when the middle of the
/// figure leaves a dead zone, then smoothly, but never lets the figure's box leave the margin; it
/// moves back when the figure grows wider than the picture, and never forth again.
class FigureTracker {
 public:
    /// @param aspect  width / height of the picture
    /// @throws ArgumentError naming the setting that is out of range
    FigureTracker(const FramingSettings& settings, double aspect);

    /// The camera for the next frame; points without a finite position are left out.
    /// @param figure  the points to keep in the picture (N x 3, m)
    /// @throws ArgumentError if no point has a finite position
    Camera follow(const Points& figure);

 private:
    struct Box {
        Vec3 low;  ///< along right, up, forward (m)
        Vec3 high;
    };
    Box box_of(const Points& figure) const;
    double depth_slack(const Box& box) const;
    void slide_in_depth(const Box& box);
    void widen(const Box& box);
    void slide_sideways(const Box& box);

    FramingSettings m_settings;
    Eigen::Matrix3d m_axes;  ///< rows: right, up and forward of the picture
    Vec3 m_tangents;         ///< of half the fields of view: horizontal, vertical (third unused)
    Vec3 m_middle = Vec3::Zero();  ///< what the camera looks at, along the axes (m)
    double m_distance = 0.0;       ///< from there to the eye (m); 0 before the first frame
};

}  // namespace cloth
