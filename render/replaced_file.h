#pragma once

#include <string>

namespace cloth {

/// A file that appears only when it is complete: write to temporary_path(), then commit().
/// Without commit() the temporary file is removed and what was at `path` stays as it was.
class ReplacedFile {
 public:
    explicit ReplacedFile(std::string path);
    ~ReplacedFile();
    ReplacedFile(const ReplacedFile&) = delete;
    ReplacedFile& operator=(const ReplacedFile&) = delete;

    const std::string& path() const { return m_path; }
    const std::string& temporary_path() const { return m_temporary_path; }

    /// Renames the temporary file to path(). @throws LoadError if that is not possible
    void commit();

 private:
    std::string m_path;
    std::string m_temporary_path;
    int m_place = -1;  ///< in the list for signals; -1: it is full
    bool m_committed = false;
};

/// From now on SIGINT, SIGTERM and SIGHUP remove the temporary files of this process before they
/// end it; signals that are ignored stay so. To be called once, by a program that does nothing else
/// at these signals.
void remove_temporary_files_at_signals();

/// Writes `text` to `path`, whole or not at all. @throws LoadError naming the file
void write_text_file(const std::string& path, const std::string& text);

}  // namespace cloth
