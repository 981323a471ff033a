#pragma once

#include <functional>
#include <string>

namespace cloth::test {

/// A kind of file and how the project reads it.
struct FileFormat {
    std::string extension;
    std::string sample;  ///< a small valid file
    /// Reads a file; returns what is wrong with the object that was made of it, "" if nothing is.
    std::function<std::string(const std::string& path)> load;
    unsigned rounds = 300;
};

/// Expects the invariants of README.md of mutations of the sample, of the sample cut anywhere, and
/// of what is no file.
void fuzz_files(const FileFormat& format);

}  // namespace cloth::test
