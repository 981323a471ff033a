#pragma once

#include "render/camera.h"

namespace cloth {

/// A camera that turns around a point, as a mouse moves it. Distances on the screen are in heights
/// of the picture, so that they do not depend on its size.
class OrbitCamera {
 public:
    /// Looks at the whole figure (N x 3, m) from the front, slightly from the side and from above.
    /// @param aspect  width / height of what the figure shall fill
    void frame(const Points& figure, double aspect);

    /// Turns around the target; a height of the picture is half a turn. It stops before the poles.
    void orbit(double right, double down);
    /// Moves the target with the mouse: what is at its depth stays under it.
    void pan(double right, double down);
    /// So many notches of the wheel; above 0 it comes nearer.
    void zoom(double notches);
    /// Moves target and eye (m), as a figure that is followed does.
    void move(const Vec3& way) { m_target += way; }

    const Vec3& target() const { return m_target; }
    double distance() const { return m_distance; }
    /// @param shift  by so much of the picture's width the target is right of its middle
    Camera camera(double shift = 0.0, double aspect = 1.0) const;

 private:
    Vec3 eye_direction() const;

    Vec3 m_target = Vec3(0, 1, 0);
    double m_yaw = 0.35, m_pitch = 0.12;  ///< of the eye around the target (rad)
    double m_distance = 4.0;              ///< (m)
};

}  // namespace cloth
