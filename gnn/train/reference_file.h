#pragma once

#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Writes positions frame by frame (each |V| x 3, m) and the velocities at the first of them
/// (|V| x 3, m/s), exactly. The folder is made if need be; a temporary file is renamed.
/// @throws LoadError naming the file if it cannot be written
void save_reference(const std::string& file, const std::vector<Points>& positions,
                    const Points& velocities);

/// @return false, nothing changed: there is no such file, or it is not of `vertices` vertices and
///         `frames` + 1 positions
bool load_reference(const std::string& file, Eigen::Index vertices, int frames,
                    std::vector<Points>& positions, Points& velocities);

}  // namespace cloth
