#include "data/files/write_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "data/core/errors.h"

namespace cloth {

WriteLock::WriteLock(const std::string& path, int flags) {
    // The other run may give the file its final name between our opening and locking it.
    for (bool is_locked = false; !is_locked;) {
        m_descriptor = open(path.c_str(), flags | O_CLOEXEC, 0666);
        if (m_descriptor < 0) return;
        if (flock(m_descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            close();
            throw LoadError(path, "", "is being written by another run",
                            "wait until it has ended, or give another path");
        }
        is_locked = is_at(path);  // or the file system has no locks
        if (!is_locked) close();
    }
}

WriteLock::~WriteLock() {
    close();
}

bool WriteLock::is_at(const std::string& path) const {
    struct stat opened {
    }, named{};
    return fstat(m_descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
           opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

void WriteLock::close() {
    if (m_descriptor >= 0) ::close(m_descriptor);
    m_descriptor = -1;
}

}  // namespace cloth
