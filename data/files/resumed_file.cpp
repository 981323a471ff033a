#include "data/files/resumed_file.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

namespace fs = std::filesystem;

ResumedFile::ResumedFile(std::string path, CacheStart start, std::string ending)
    : m_path(std::move(path)), m_ending(std::move(ending)), m_file(nullptr) {
    std::error_code none;
    const bool is_there = start == CacheStart::go_on && fs::is_regular_file(m_path, none);
    m_file = std::fopen(m_path.c_str(), is_there ? "r+b" : "w+b");
    if (!m_file) fail();
    if (is_there) find_what_is_there();
}

ResumedFile::~ResumedFile() {
    if (m_file) std::fclose(m_file);
}

void ResumedFile::fail() const {
    throw LoadError(m_path, "", "cannot be written",
                    "check that the folder exists, may be written to and has space");
}

void ResumedFile::find_what_is_there() {
    std::error_code error;
    m_there = fs::file_size(m_path, error);
    if (error) fail();
    std::string last(static_cast<size_t>(std::min<std::uintmax_t>(m_there, m_ending.size())), '\0');
    if (std::fseek(m_file, -static_cast<long>(last.size()), SEEK_END) != 0 ||
        std::fread(last.data(), 1, last.size(), m_file) != last.size())
        fail();
    // Of an ending that was cut, too, what is there does not count.
    while (last != m_ending.substr(0, last.size())) last.erase(0, 1);
    m_there -= last.size();
}

void ResumedFile::write(const std::string& bytes, const std::string& place) {
    if (m_at + bytes.size() <= m_there)
        compare(bytes, place);
    else if (m_at < m_there)  // a piece that was cut
        compare(bytes.substr(0, static_cast<size_t>(m_there - m_at)), place), append(bytes);
    else
        append(bytes);
    m_at += bytes.size();
}

void ResumedFile::compare(const std::string& bytes, const std::string& place) {
    std::string there(bytes.size(), '\0');
    if (std::fseek(m_file, static_cast<long>(m_at), SEEK_SET) != 0) fail();
    const size_t count = std::fread(there.data(), 1, there.size(), m_file);
    if (count != there.size() || there != bytes)
        throw LoadError(m_path, place, "it differs from what is computed now",
                        "go on with the settings, program and machine that it was begun with, or "
                        "begin it anew");
}

void ResumedFile::append(const std::string& bytes) {
    const std::string all = bytes + m_ending;
    const bool written = std::fseek(m_file, static_cast<long>(m_at), SEEK_SET) == 0 &&
                         std::fwrite(all.data(), 1, all.size(), m_file) == all.size() &&
                         std::fflush(m_file) == 0;
    if (!written) fail();
}

void ResumedFile::commit(const std::string& final_path) {
    const bool closed = std::fclose(std::exchange(m_file, nullptr)) == 0;
    std::error_code error;
    if (closed) fs::resize_file(m_path, m_at + m_ending.size(), error);
    if (!closed || error) fail();
    fs::rename(m_path, final_path, error);
    if (error)
        throw LoadError(
            final_path, "", "cannot be replaced (" + error.message() + ")",
            "choose a path in a folder that you may write to; what was computed is in " + m_path);
}

}  // namespace cloth
