#include "data/files/resumed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

namespace fs = std::filesystem;

ResumedFile::ResumedFile(std::string path, CacheStart start, std::string ending)
    : m_path(std::move(path)),
      m_ending(std::move(ending)),
      m_lock(m_path, O_RDWR | O_CREAT),
      m_file(nullptr, std::fclose) {
    const int file = m_lock.descriptor();
    if (file < 0 || (start == CacheStart::anew && ftruncate(file, 0) != 0)) fail();
    m_file.reset(fdopen(fcntl(file, F_DUPFD_CLOEXEC, 0), "r+b"));
    if (!m_file) fail();
    if (start == CacheStart::go_on) find_what_is_there();
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
    if (std::fseek(m_file.get(), -static_cast<long>(last.size()), SEEK_END) != 0 ||
        std::fread(last.data(), 1, last.size(), m_file.get()) != last.size())
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
    if (std::fseek(m_file.get(), static_cast<long>(m_at), SEEK_SET) != 0) fail();
    const size_t count = std::fread(there.data(), 1, there.size(), m_file.get());
    if (count != there.size() || there != bytes)
        throw LoadError(m_path, place, "it differs from what is computed now",
                        "go on with the settings, program and machine that it was begun with, or "
                        "begin it anew");
}

void ResumedFile::append(const std::string& bytes) {
    const std::string all = bytes + m_ending;
    const bool written = std::fseek(m_file.get(), static_cast<long>(m_at), SEEK_SET) == 0 &&
                         std::fwrite(all.data(), 1, all.size(), m_file.get()) == all.size() &&
                         std::fflush(m_file.get()) == 0;
    if (!written) fail();
}

void ResumedFile::commit(const std::string& final_path) {
    const bool closed = std::fclose(m_file.release()) == 0;
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
