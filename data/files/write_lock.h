#pragma once

#include <string>

namespace cloth {

/// A file or folder that is open and that one run at a time may write to (flock(2)): the lock ends
/// with this object, or with the process, however that ends.
class WriteLock {
 public:
    /// @param flags  of open(2), such as O_RDWR | O_CREAT; O_TRUNC would cut what another run
    ///               writes, so cut the file afterwards
    /// @throws LoadError if another run, or another object of this one, has it
    WriteLock(const std::string& path, int flags);
    ~WriteLock();
    WriteLock(const WriteLock&) = delete;
    WriteLock& operator=(const WriteLock&) = delete;

    /// File descriptor; negative if the file could not be opened.
    int descriptor() const { return m_descriptor; }

 private:
    /// Whether the path still names what was opened.
    bool is_at(const std::string& path) const;
    void close();

    int m_descriptor = -1;
};

}  // namespace cloth
