#pragma once

#include <optional>
#include <string>

namespace cloth {

/// Path of a file that the project ships: `relative` to data/assets of the source tree, or to the
/// folder in the environment variable CLOTH_ASSETS.
/// @throws LoadError if there is no such file
std::string asset_path(const std::string& relative);

/// Path of a file of Debian's package assimp-testmodels: `relative` to /usr/share/assimp/models, or
/// to the folder in the environment variable CLOTH_MODELS.
/// @throws LoadError if there is no such file
std::string model_path(const std::string& relative);

/// Path of an optional file or folder of the shared data folder (the environment variable
/// CLOTH_SHARED_DATA, else ../shared/data beside the source tree); nothing if it is not there.
std::optional<std::string> shared_data_path(const std::string& relative);

}  // namespace cloth
