#include "data/files/make_folder.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "data/core/errors.h"

namespace cloth {

void make_folder(const std::string& path) {
    namespace fs = std::filesystem;
    const auto refuse = [&](const std::string& problem, const std::error_code& why) {
        throw LoadError(path, "", problem + " (" + why.message() + ")",
                        "give a folder, or one that can be made, in a place where you may write");
    };
    std::error_code error, none;
    fs::create_directories(path, error);
    if (!fs::is_directory(path, none))
        refuse("the folder cannot be made",
               error ? error : std::make_error_code(std::errc::not_a_directory));
    if (access(path.c_str(), W_OK | X_OK) != 0)
        refuse("the folder may not be written to", {errno, std::generic_category()});
}

}  // namespace cloth
