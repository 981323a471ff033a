#pragma once

#include <string>
#include <vector>

#include "data/core/cloth_state.h"

namespace cloth {

/// The states of a garment frame by frame, the start included.
using Trajectory = std::vector<ClothState>;

/// Writes a trajectory (doubles, exact), whole or not at all. @throws LoadError naming the file
void save_trajectory(const std::string& path, const Trajectory& trajectory);

/// @throws LoadError if the file is missing, truncated, or not a trajectory
Trajectory load_trajectory(const std::string& path);

/// Root of the mean squared distance of corresponding vertices (mm).
double rmse_mm(const Points& a, const Points& b);

}  // namespace cloth
