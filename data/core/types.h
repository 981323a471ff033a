#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "data/core/eigen_layout.h"

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
