#include "tests/fuzz/file_fuzzing.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "tests/fuzz/file_mutations.h"
#include "tests/fuzz/memory_meter.h"

namespace cloth::test {
namespace {

namespace fs = std::filesystem;

constexpr size_t memory_of_a_library = size_t{24} << 20;  // bytes: assimp's buffer takes 16 MiB
constexpr size_t memory_per_byte = 100;  // a JSON value takes 40 bytes for two characters
constexpr rlim_t longest_load = 20;      // s of processor time, under sanitizers too

/// A folder of its own for each test, gone afterwards.
class Folder {
 public:
    Folder() {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        m_path = fs::temp_directory_path() / (std::string("fuzz_") + info->name());
        fs::remove_all(m_path);
        fs::create_directories(m_path);
    }
    ~Folder() { fs::remove_all(m_path); }
    const fs::path& path() const { return m_path; }
    std::string file(const std::string& name) const { return (m_path / name).string(); }

 private:
    fs::path m_path;
};

/// Reads the file and looks at what comes of it; "" if the invariants hold.
std::string read_and_judge(const FileFormat& format, const std::string& path, size_t size) {
    const size_t most = memory_of_a_library + memory_per_byte * size;
    const MemoryMeter meter;
    try {
        const std::string problem = format.load(path);
        if (!problem.empty()) return problem;
    } catch (const LoadError& error) {
        const std::string text = error.what();
        if (text.find(path) == std::string::npos) return "the file is not named: " + text;
        if (text.find("Remedy: ") == std::string::npos) return "there is no remedy: " + text;
    } catch (const std::exception& error) {
        return std::string("another exception: ") + error.what();
    }
    return meter.peak() <= most ? "" : "it took " + std::to_string(meter.peak()) + " bytes";
}

std::string text_of(int pipe) {
    std::string text;
    char buffer[4096];
    for (ssize_t n; (n = ::read(pipe, buffer, sizeof buffer)) > 0;)
        text.append(buffer, static_cast<size_t>(n));
    ::close(pipe);
    return text;
}

/// As read_and_judge(), in a process of its own: a crash or a file that is never done is a finding
/// like others and does not hide them.
std::string outcome(const FileFormat& format, const std::string& path, size_t size) {
    int ends[2];
    if (::pipe(ends) != 0) return "no pipe";
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit limit{longest_load, longest_load};
        ::setrlimit(RLIMIT_CPU, &limit);
        const std::string problem = read_and_judge(format, path, size);
        const bool written = ::write(ends[1], problem.data(), problem.size()) >= 0;
        ::_exit(written ? 0 : 1);
    }
    ::close(ends[1]);
    const std::string problem = text_of(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return problem;
    if (WIFEXITED(status)) return "it ended with a report of a sanitizer";
    return std::string("it crashed or took too long: ") + ::strsignal(WTERMSIG(status));
}

void check_content(const FileFormat& format, const Folder& folder, const std::string& content) {
    const std::string path = folder.file("file." + format.extension);
    std::ofstream(path, std::ios::binary) << content;
    const std::string problem = outcome(format, path, content.size());
    if (problem.empty()) return;
    const fs::path kept = folder.path().string() + "_failed." + format.extension;
    fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
    ADD_FAILURE() << problem << "\nthe file is kept as " << kept;
}

void check_what_is_no_file(const FileFormat& format, const Folder& folder) {
    SCOPED_TRACE("no file, a folder, nothing in it");
    const std::string missing = folder.file("missing." + format.extension);
    EXPECT_THROW(format.load(missing), LoadError);
    EXPECT_EQ(outcome(format, missing, 0), "");
    const std::string directory = folder.file("folder." + format.extension);
    fs::create_directories(directory);
    EXPECT_THROW(format.load(directory), LoadError);
    EXPECT_EQ(outcome(format, directory, 0), "");
    check_content(format, folder, "");
    check_content(format, folder, std::string(1000, '\0'));
}

}  // namespace

void fuzz_files(const FileFormat& format) {
    const Folder folder;
    check_content(format, folder, format.sample);
    EXPECT_NO_THROW(format.load(folder.file("file." + format.extension))) << "the sample is valid";
    check_what_is_no_file(format, folder);
    for (size_t part = 0; part < 100; ++part) {
        SCOPED_TRACE("cut after " + std::to_string(part) + " %");
        check_content(format, folder, format.sample.substr(0, part * format.sample.size() / 100));
    }
    for_each_seed(format.rounds, [&](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        check_content(format, folder, mutated(format.sample, random));
    });
}

}  // namespace cloth::test
