#include "render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr double kPi = 3.14159265358979323846;

double half_angle(double fov_deg) {
    return 0.5 * fov_deg * kPi / 180.0;
}

/// Rows: right, up and forward.
Eigen::Matrix3d axes_of(const std::string& who, const Vec3& direction, const Vec3& up) {
    const Vec3 right = direction.cross(up);
    const bool usable = right.allFinite() && right.norm() > 1e-9 * direction.norm() * up.norm();
    if (!usable)
        throw ArgumentError(who, "the view direction is zero, not finite or along `up`",
                            "look at a point other than the eye, and not straight along `up`");
    Eigen::Matrix3d axes;
    axes.row(2) = direction.normalized();
    axes.row(0) = right.normalized();
    axes.row(1) = right.cross(direction).normalized();
    return axes;
}

}  // namespace

Eigen::Matrix4d view_matrix(const Camera& camera) {
    const Eigen::Matrix3d axes = axes_of("Camera", camera.target - camera.eye, camera.up);
    Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
    view.topLeftCorner<3, 3>() = axes;
    view.row(2) *= -1.0;
    view(2, 3) = 0.0;
    view.topRightCorner<3, 1>() = -view.topLeftCorner<3, 3>() * camera.eye;
    return view;
}

Eigen::Matrix4d projection_matrix(const Camera& camera, double aspect) {
    check_range("Camera.fov_y_deg", camera.fov_y_deg, 5.0, 120.0);
    check_range("Camera.near_plane", camera.near_plane, 1e-6, 1e6);
    check_range("Camera.far_plane", camera.far_plane, 1.001 * camera.near_plane, 1e9);
    check_range("aspect", aspect, 0.01, 100.0);
    const double scale = 1.0 / std::tan(half_angle(camera.fov_y_deg));
    const double depth = camera.near_plane - camera.far_plane;
    Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
    projection(0, 0) = scale / aspect;
    projection(1, 1) = scale;
    projection(2, 2) = (camera.near_plane + camera.far_plane) / depth;
    projection(2, 3) = 2.0 * camera.near_plane * camera.far_plane / depth;
    projection(3, 2) = -1.0;
    return projection;
}

PixelPosition project(const Camera& camera, const Vec3& point, int width, int height) {
    const Eigen::Vector4d clip = projection_matrix(camera, static_cast<double>(width) / height) *
                                 view_matrix(camera) * point.homogeneous();
    return {0.5 * width * (1.0 + clip.x() / clip.w()), 0.5 * height * (1.0 - clip.y() / clip.w()),
            clip.w()};
}

FigureTracker::FigureTracker(const FramingSettings& settings, double aspect)
    : m_settings(settings), m_axes(axes_of("FramingSettings", settings.direction, settings.up)) {
    check_range("FramingSettings.fov_y_deg", settings.fov_y_deg, 5.0, 120.0);
    check_range("FramingSettings.margin", settings.margin, 0.0, 0.2);
    check_range("FramingSettings.dead_zone", settings.dead_zone, 0.0, 0.2);
    check_range("FramingSettings.smoothing", settings.smoothing, 0.0, 1.0);
    check_range("aspect", aspect, 0.01, 100.0);
    const double tangent = std::tan(half_angle(settings.fov_y_deg));
    m_tangents = Vec3(tangent * aspect, tangent, 0.0);
}

Camera FigureTracker::follow(const Points& figure) {
    const Box box = box_of(figure);
    if (m_distance == 0.0) m_middle = 0.5 * (box.low + box.high);
    slide_in_depth(box);
    widen(box);
    slide_sideways(box);
    Camera camera;
    camera.target = m_axes.transpose() * m_middle;
    camera.eye = camera.target - m_distance * m_axes.row(2).transpose();
    camera.up = m_settings.up;
    camera.fov_y_deg = m_settings.fov_y_deg;
    camera.near_plane = 0.02 * m_distance;
    camera.far_plane = 20.0 * m_distance;
    return camera;
}

FigureTracker::Box FigureTracker::box_of(const Points& figure) const {
    Box box{Vec3::Constant(std::numeric_limits<double>::infinity()),
            Vec3::Constant(-std::numeric_limits<double>::infinity())};
    for (Eigen::Index i = 0; i < figure.rows(); ++i) {
        if (!figure.row(i).allFinite()) continue;
        const Vec3 point = m_axes * figure.row(i).transpose();
        box.low = box.low.cwiseMin(point);
        box.high = box.high.cwiseMax(point);
    }
    if (!box.low.allFinite())
        throw ArgumentError("FigureTracker::follow", "no point has a finite position",
                            "pass the vertices of the body, which the solvers do not move");
    return box;
}

/// In depth the camera follows softly, too, but never falls far behind.
void FigureTracker::slide_in_depth(const Box& box) {
    const double middle = 0.5 * (box.low.z() + box.high.z());
    const double slack = depth_slack(box);
    const double wanted = std::clamp(m_middle.z(), middle - slack, middle + slack);
    m_middle.z() += m_settings.smoothing * (wanted - m_middle.z());
    m_middle.z() = std::clamp(m_middle.z(), middle - 3.0 * slack, middle + 3.0 * slack);
}

double FigureTracker::depth_slack(const Box& box) const {
    return m_settings.dead_zone * (box.high - box.low).norm();
}

/// Moves back until the box fits between the margins, with the dead zone to spare, even where it is
/// nearest to the eye.
void FigureTracker::widen(const Box& box) {
    const double half_depth = 0.5 * (box.high.z() - box.low.z());
    const double nearest = std::max(m_middle.z() - box.low.z(), half_depth + depth_slack(box));
    const double room = 1.0 - 2.0 * (m_settings.margin + m_settings.dead_zone);
    for (int axis = 0; axis < 2; ++axis) {
        const double half = 0.5 * (box.high[axis] - box.low[axis]);
        m_distance = std::max(m_distance, half / (m_tangents[axis] * room) + nearest);
    }
    m_distance = std::max(m_distance, nearest + 1e-3);
}

void FigureTracker::slide_sideways(const Box& box) {
    const double nearest_distance = m_distance - (m_middle.z() - box.low.z());
    for (int axis = 0; axis < 2; ++axis) {
        const double middle = 0.5 * (box.low[axis] + box.high[axis]);
        const double half = 0.5 * (box.high[axis] - box.low[axis]);
        const double half_side = m_tangents[axis] * nearest_distance;
        const double slack = 2.0 * m_settings.dead_zone * half_side;
        const double wanted = std::clamp(m_middle[axis], middle - slack, middle + slack);
        m_middle[axis] += m_settings.smoothing * (wanted - m_middle[axis]);
        // The hard limit: the nearest corner of the box stays inside the margin.
        const double limit = std::max(0.0, (1.0 - 2.0 * m_settings.margin) * half_side - half);
        m_middle[axis] = std::clamp(m_middle[axis], middle - limit, middle + limit);
    }
}

}  // namespace cloth
