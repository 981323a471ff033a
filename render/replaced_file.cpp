#include "render/replaced_file.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

namespace {

/// A file that is being written. A handler of signals may read nothing that is allocated, so there
/// is a fixed number of them.
struct TemporaryFile {
    std::atomic<bool> is_taken{false}, is_there{false};
    char path[PATH_MAX];
};
std::array<TemporaryFile, 32> temporary_files;

int remember(const std::string& path) {
    if (path.size() >= PATH_MAX) return -1;
    for (size_t k = 0; k < temporary_files.size(); ++k) {
        if (temporary_files[k].is_taken.exchange(true)) continue;
        std::strcpy(temporary_files[k].path, path.c_str());
        temporary_files[k].is_there = true;
        return static_cast<int>(k);
    }
    return -1;
}

void forget(int place) {
    if (place < 0) return;
    TemporaryFile& file = temporary_files[static_cast<size_t>(place)];
    file.is_there = false;
    file.is_taken = false;
}

void remove_temporary_files(int signal) {
    for (const TemporaryFile& file : temporary_files)
        if (file.is_there) unlink(file.path);
    raise(signal);  // its own action is back, see SA_RESETHAND
}

}  // namespace

ReplacedFile::ReplacedFile(std::string path)
    : m_path(std::move(path)), m_temporary_path(m_path + "." + std::to_string(getpid()) + ".tmp") {
    m_place = remember(m_temporary_path);
}

ReplacedFile::~ReplacedFile() {
    forget(m_place);
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
    forget(m_place);
    m_place = -1;
}

void remove_temporary_files_at_signals() {
    struct sigaction action {};
    action.sa_handler = remove_temporary_files;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // as nohup has it
    }
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
