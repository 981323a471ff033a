#include "demos/viewer/orbit_camera.h"

#include <algorithm>
#include <cmath>

namespace cloth {
namespace {

constexpr double fov = 30.0;  // (degrees)
constexpr double steepest = 1.5, nearest = 0.2, farthest = 50.0;

/// Half the height of the picture at a distance of 1 m (m).
double half_height() {
    return std::tan(fov * M_PI / 360.0);
}

}  // namespace

void OrbitCamera::frame(const Points& figure, double aspect) {
    const Vec3 low = figure.colwise().minCoeff(), high = figure.colwise().maxCoeff();
    *this = OrbitCamera();
    m_target = 0.5 * (low + high);
    const double height = high.y() - low.y(), width = high.x() - low.x();
    const double room = 1.2 * std::max(height, width / aspect);
    m_distance =
        std::clamp(0.5 * room / half_height() + 0.5 * (high.z() - low.z()), nearest, farthest);
}

void OrbitCamera::orbit(double right, double down) {
    m_yaw = std::remainder(m_yaw - M_PI * right, 2.0 * M_PI);
    m_pitch = std::clamp(m_pitch + M_PI * down, -steepest, steepest);
}

void OrbitCamera::pan(double right, double down) {
    const double scale = 2.0 * half_height() * m_distance;
    const Vec3 back = eye_direction();
    const Vec3 side = Vec3::UnitY().cross(back).normalized();
    m_target += scale * (-right * side + down * back.cross(side));
}

void OrbitCamera::zoom(double notches) {
    m_distance = std::clamp(m_distance * std::pow(0.88, notches), nearest, farthest);
}

Vec3 OrbitCamera::eye_direction() const {
    return {std::cos(m_pitch) * std::sin(m_yaw), std::sin(m_pitch),
            std::cos(m_pitch) * std::cos(m_yaw)};
}

Camera OrbitCamera::camera(double shift, double aspect) const {
    Camera camera;
    const Vec3 back = eye_direction();
    const Vec3 side = Vec3::UnitY().cross(back).normalized();
    const Vec3 moved = m_target - 2.0 * shift * aspect * half_height() * m_distance * side;
    camera.target = moved;
    camera.eye = moved + m_distance * back;
    camera.fov_y_deg = fov;
    camera.near_plane = std::max(0.02, 0.02 * m_distance);
    camera.far_plane = 100.0;
    return camera;
}

}  // namespace cloth
