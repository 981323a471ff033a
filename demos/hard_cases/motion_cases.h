#pragma once

#include <string>
#include <vector>

#include "demos/hard_cases/hard_cases.h"

namespace cloth {

/// A garment (of data/assets/garments) on the default body, from the rest pose through a whole
/// motion: "motion-NAME". Its bound of stretch is 1.1 times the reference's, where that is run too.
/// @param motion  as load_motion_by_name() takes it
/// @param limbs   cloth passes through limbs that pass through others; else "motion-NAME-no-limbs"
/// @throws LoadError, ArgumentError, UsageError if the garment or the motion cannot be had
HardCase motion_case(const std::string& motion, const std::string& garment, bool limbs = true);

/// The motions with the folders among them replaced by the BVH files that they hold.
/// @throws LoadError for a folder without any
std::vector<std::string> with_folders_listed(const std::vector<std::string>& motions);

}  // namespace cloth
