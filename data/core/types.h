#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

// Other layouts crash: memory that one side allocates is freed by the other. The definitions come
// with the CMake targets and with `pkg-config --cflags fastcloth`.
static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 64 && EIGEN_MAX_STATIC_ALIGN_BYTES == 16 &&
                  EIGEN_MALLOC_ALREADY_ALIGNED == 0,
              "FastCloth needs -DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 in "
              "every file that includes it: link its CMake targets, or add the flags of "
              "`pkg-config --cflags fastcloth`");

namespace cloth {

using Vec3 = Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;  ///< (N x 3)
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;      ///< (M x 3)
using VectorX = Eigen::VectorXd;

/// Equal in number and in every coordinate.
inline bool same_points(const Points& a, const Points& b) {
    return a.rows() == b.rows() && a == b;
}

}  // namespace cloth
