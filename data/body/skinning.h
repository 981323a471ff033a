#pragma once

#include <vector>

#include "data/body/skin_weights.h"

namespace cloth {

/// Affine map x' = M (x, 1) of one joint.
using SkinMatrix = Eigen::Matrix<double, 3, 4>;

/// Linear blend skinning: x'_i = sum over joints j of w_ij M_j (x_i, 1).
/// @param rest      |V| x 3 (m)
/// @param matrices  one per joint that `weights` names
Points skin_points(const Points& rest, const SkinWeights& weights,
                   const std::vector<SkinMatrix>& matrices);

}  // namespace cloth
