#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "data/files/write_lock.h"

namespace cloth {

/// Whether a cache is begun, or one goes on whose writing was interrupted.
enum class CacheStart { anew, go_on };

/// A file that is written piece by piece under a temporary name and renamed when it is whole. What
/// is there can be read at any time, and it stays when the writing is interrupted. Going on, one
/// writes everything again from the first byte: what is there is compared, what is missing is
/// appended. So it ends as if nothing had happened, or with an error. One run at a time writes to
/// it.
///
///     ResumedFile file("shirt.part.pc2", CacheStart::go_on);
///     file.write(header, "header");
///     for (const std::string& frame : frames) file.write(frame, "a frame");
///     file.commit("shirt.pc2");
class ResumedFile {
 public:
    /// @param ending  what stands at the end of the file after every write(), such as a closing
    ///                bracket; the next one replaces it
    /// @throws LoadError if the file cannot be opened for writing, or another run writes to it
    ResumedFile(std::string path, CacheStart start, std::string ending = {});
    ResumedFile(const ResumedFile&) = delete;
    ResumedFile& operator=(const ResumedFile&) = delete;

    /// Whole, in the file and not only in a buffer, when it returns.
    /// @param place  what these bytes are, for the message
    /// @throws LoadError if the file has other bytes there, or the disk is full
    void write(const std::string& bytes, const std::string& place);

    /// Closes the file, cuts off what was not written, and renames it. @throws LoadError
    void commit(const std::string& final_path);

 private:
    void find_what_is_there();
    void compare(const std::string& bytes, const std::string& place);
    void append(const std::string& bytes);
    [[noreturn]] void fail() const;

    std::string m_path, m_ending;
    WriteLock m_lock;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> m_file;
    std::uintmax_t m_there = 0;  ///< bytes that an earlier run left, without the ending
    std::uintmax_t m_at = 0;     ///< where the next piece begins
};

}  // namespace cloth
