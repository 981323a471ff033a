#pragma once

#include <string>

namespace cloth {

/// Makes the folder, and those that it lies in, where they are missing. To be called before hours
/// are spent on what is to be written there.
/// @throws LoadError if it cannot be made, or may not be written to
void make_folder(const std::string& path);

}  // namespace cloth
