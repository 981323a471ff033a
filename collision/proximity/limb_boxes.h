#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "data/core/boundary.h"

namespace cloth {

/// The axis-parallel boxes of a body's limbs: which limbs a point may be near, and which ones a ray
/// may meet, without a search. Limbs of several obstacles that have one number share a box. They
/// are kept in single precision and a little too large.
class LimbBoxes {
 public:
    /// Fits the boxes to the obstacles with limbs at one end of the step. Coordinates that are not
    /// numbers are left out.
    /// @param has_limbs  of each obstacle, see cloth::has_limbs()
    void fit(const Boundary& boundary, const std::vector<char>& has_limbs, StepEnd end);

    /// The limbs whose boxes are within `reach` (m) of x along each axis.
    LimbSet near(const Vec3& x, double reach) const;

    /// The limbs whose boxes the ray from x along the unit vector `direction` meets within `length`
    /// (m), or misses by little.
    LimbSet along(const Vec3& x, const Vec3& direction, double length) const;

 private:
    using Row = std::array<float, max_limbs>;
    /// A mesh that was seen; the pointers are held, so that they stay keys.
    struct Mesh {
        std::shared_ptr<const Faces> faces;
        std::shared_ptr<const std::vector<std::uint8_t>> limbs;
        std::array<std::vector<int>, max_limbs> vertices;  ///< of each limb, ascending
    };

    const Mesh& known(const Obstacle& obstacle);
    void fit(const std::vector<int>& vertices, const Points& x, size_t limb);

    std::vector<Mesh> m_meshes;
    std::array<Row, 3> m_low = {}, m_high = {};  ///< (m), those of limbs without vertices are empty
};

}  // namespace cloth
