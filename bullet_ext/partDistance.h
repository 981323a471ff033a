#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bullet_ext/bulletShapes.h"
#include "data/core/surface_distance.h"

namespace cloth {

/// Signed distance to a solid that does not change its shape: what the reaction of cloth on a rigid
/// body is found with. (Steppers find their contacts themselves.)
class PartDistance {
 public:
    explicit PartDistance(const ShapePart& part);

    /// Distance (m, negative inside) of a point in the frame of the whole shape; none if it is
    /// farther than `radius`.
    std::optional<double> at(const Vec3& point, double radius) const;

 private:
    Obstacle m_primitive;   ///< of a mesh only the shape counts
    double m_extent = 0.0;  ///< of a primitive from its centre (m), infinite for a plane
    Pose m_inverse;         ///< from the whole shape's frame to the primitive's
    Vec3 m_low, m_high;     ///< bounds of a mesh (m)
    std::unique_ptr<SurfaceDistance> m_mesh;
};

}  // namespace cloth
