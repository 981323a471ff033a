#include "data/core/paths.h"

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "data/core/errors.h"

namespace cloth {

namespace {

namespace fs = std::filesystem;

std::string folder(const char* variable, const std::string& standard) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value != '\0' ? value : standard;
}

}  // namespace

std::string asset_path(const std::string& relative, const std::string& installed) {
    const std::string chosen = folder("CLOTH_ASSETS", "");
    std::vector<std::string> folders = {chosen};
    if (chosen.empty()) folders = {installed, CLOTH_ASSETS_DIR, CLOTH_INSTALL_ASSETS_DIR};
    std::string searched;
    for (const std::string& place : folders) {
        if (place.empty()) continue;
        const fs::path path = fs::path(place) / relative;
        if (fs::exists(path)) return path.string();
        searched += (searched.empty() ? "" : " and ") + place;
    }
    throw LoadError(relative, "",
                    "no such file in " + searched + (chosen.empty() ? "" : ", by CLOTH_ASSETS"),
                    "set the environment variable CLOTH_ASSETS to PREFIX/share/fastcloth/assets of "
                    "an installation, which `pkg-config --variable=assets fastcloth` prints, or to "
                    "data/assets of the source tree");
}

std::string model_path(const std::string& relative) {
    const fs::path path = fs::path(folder("CLOTH_MODELS", "/usr/share/assimp/models")) / relative;
    if (!fs::exists(path)) {
        throw LoadError(path.string(), "", "no such file",
                        "apt-get install assimp-testmodels, or set the environment variable "
                        "CLOTH_MODELS to its folder of models");
    }
    return path.string();
}

std::optional<std::string> shared_data_path(const std::string& relative) {
    const fs::path path = fs::path(folder("CLOTH_SHARED_DATA", CLOTH_SHARED_DATA_DIR)) / relative;
    if (!fs::exists(path)) return std::nullopt;
    return path.string();
}

}  // namespace cloth
