#include "render/replaced_file.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

ReplacedFile::ReplacedFile(std::string path)
    : m_path(std::move(path)), m_temporary_path(m_path + "." + std::to_string(getpid()) + ".tmp") {
}

ReplacedFile::~ReplacedFile() {
    std::error_code ignored;
    if (!m_committed) std::filesystem::remove(m_temporary_path, ignored);
}

void ReplacedFile::commit() {
    std::error_code error;
    std::filesystem::rename(m_temporary_path, m_path, error);
    if (error)
        throw LoadError(m_path, "", "cannot be replaced (" + error.message() + ")",
                        "choose a path in a folder that you may write to");
    m_committed = true;
}

void write_text_file(const std::string& path, const std::string& text) {
    ReplacedFile file(path);
    std::ofstream stream(file.temporary_path(), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
        throw LoadError(path, "", "cannot be written",
                        "check that the folder exists, may be written to and has space left");
    file.commit();
}

}  // namespace cloth
