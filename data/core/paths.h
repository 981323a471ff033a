#pragma once

#include <optional>
#include <string>

namespace cloth {

// Programs that use an installed FastCloth are compiled with the folder of its assets.
#ifndef CLOTH_INSTALLED_ASSETS
#define CLOTH_INSTALLED_ASSETS ""
#endif

/// Path of a file that the project ships: `relative` to the folder in the environment variable
/// CLOTH_ASSETS, else to that of the installation the program is compiled for, else to data/assets
/// of the source tree the library was built from, else to where that was to be installed.
/// @throws LoadError if there is no such file
std::string asset_path(const std::string& relative,
                       const std::string& installed = CLOTH_INSTALLED_ASSETS);

/// Path of a file of Debian's package assimp-testmodels: `relative` to /usr/share/assimp/models, or
/// to the folder in the environment variable CLOTH_MODELS.
/// @throws LoadError if there is no such file
std::string model_path(const std::string& relative);

/// Path of an optional file or folder of the shared data folder (the environment variable
/// CLOTH_SHARED_DATA, else ../shared/data beside the source tree); nothing if it is not there.
std::optional<std::string> shared_data_path(const std::string& relative);

}  // namespace cloth
