#include "data/core/read_file.h"

#include <filesystem>
#include <fstream>

#include "data/core/errors.h"

namespace cloth {

std::string read_file(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        throw LoadError(path, "", "is a folder", "give the path of a file");
    std::ifstream file(path, std::ios::binary);
    if (!file) throw LoadError(path, "", "cannot be opened", "check path and permissions");
    std::string bytes;
    char buffer[65536];
    while (file.read(buffer, sizeof buffer) || file.gcount() > 0)
        bytes.append(buffer, static_cast<size_t>(file.gcount()));
    if (file.bad()) throw LoadError(path, "", "cannot be read", "check the disk and permissions");
    return bytes;
}

std::string read_text_file(const std::string& path) {
    static const std::string mark = "\xEF\xBB\xBF";
    std::string text = read_file(path);
    if (text.compare(0, mark.size(), mark) == 0) text.erase(0, mark.size());
    return text;
}

}  // namespace cloth
