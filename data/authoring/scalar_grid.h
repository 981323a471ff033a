#pragma once

#include <functional>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// A function sampled on a regular grid; a surface is where it is zero, its inside where negative.
class ScalarGrid {
 public:
    /// Samples `f` in the box from `low` to at least `high` (m), in steps of `cell` (m).
    ScalarGrid(const Vec3& low, const Vec3& high, double cell,
               const std::function<double(const Vec3&)>& f);

    /// Convolves with a Gaussian of about sqrt(passes / 2) cells, per axis the kernel (1 2 1) / 4.
    void blur(int passes);

    /// The zero surface as triangles, counter-clockwise seen from outside (marching tetrahedra).
    /// Watertight, except where it leaves the box.
    TriMesh zero_surface() const;

 private:
    size_t index(int i, int j, int k) const {
        return (static_cast<size_t>(k) * static_cast<size_t>(m_size[1]) + static_cast<size_t>(j)) *
                   static_cast<size_t>(m_size[0]) +
               static_cast<size_t>(i);
    }
    Vec3 position(size_t index) const;
    void blur_axis(int axis);

    Vec3 m_low;
    double m_cell;
    Eigen::Vector3i m_size;
    std::vector<double> m_values;
};

}  // namespace cloth
