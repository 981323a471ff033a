#pragma once

#include <string>
#include <vector>

namespace cloth {

/// How a program that was run has ended.
struct ChildResult {
    int status = 0;            ///< exit status; 128 and more: the signal that ended it
    double processor_s = 0.0;  ///< time of all its threads (s)
    double peak_mb = 0.0;      ///< most memory that it held (MB)
    bool interrupted = false;  ///< this program was asked to stop meanwhile
};

/// Runs a program until it ends. SIGINT and SIGTERM are handed on to it, once.
/// @param log  file that its output is added to
/// @throws LoadError if it cannot be started
ChildResult run_child(const std::vector<std::string>& command, const std::string& log);

}  // namespace cloth
