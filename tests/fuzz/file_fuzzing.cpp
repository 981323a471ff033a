#include "tests/fuzz/file_fuzzing.h"

#include <gtest/gtest.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "data/core/errors.h"
#include "tests/fuzz/file_mutations.h"
#include "tests/fuzz/memory_meter.h"

namespace cloth::test {
namespace {

namespace fs = std::filesystem;

constexpr size_t memory_of_a_library = size_t{24} << 20;  // bytes: assimp's buffer takes 16 MiB
constexpr size_t memory_per_byte = 100;  // a JSON value takes 40 bytes for two characters
constexpr time_t longest_load = 20;      // s of processor time, under sanitizers too

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

bool read_all(int pipe, void* to, size_t size) {
    for (size_t done = 0; done < size;) {
        const ssize_t n = ::read(pipe, static_cast<char*>(to) + done, size - done);
        if (n <= 0) return false;
        done += static_cast<size_t>(n);
    }
    return true;
}

void write_all(int pipe, const void* from, size_t size) {
    for (size_t done = 0; done < size;) {
        const ssize_t n = ::write(pipe, static_cast<const char*>(from) + done, size - done);
        if (n <= 0) ::_exit(1);
        done += static_cast<size_t>(n);
    }
}

using Judge = std::function<std::string(size_t)>;

/// Judges `first` to `count` - 1 and ends the process.
[[noreturn]] void judge_and_exit(size_t first, size_t count, const Judge& judge, int pipe) {
    for (size_t k = first; k < count; ++k) {
        const itimerval limit{{0, 0}, {longest_load, 0}};
        ::setitimer(ITIMER_PROF, &limit, nullptr);
        const std::string problem = judge(k);
        const size_t size = problem.size();
        write_all(pipe, &size, sizeof size);
        write_all(pipe, problem.data(), size);
    }
    ::_exit(0);
}

std::string how_it_ended(int status) {
    if (WIFEXITED(status)) return "it ended with a report of a sanitizer";
    return std::string("it crashed or took too long: ") + ::strsignal(WTERMSIG(status));
}

/// What `judge` says of 0 to `count` - 1 in another process: a crash or a file that is never done
/// is a finding like others, and a new process goes on behind it.
void judge_apart(size_t count, const Judge& judge,
                 const std::function<void(size_t, const std::string& problem)>& found) {
    for (size_t k = 0; k < count;) {
        int ends[2];
        if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
        const pid_t child = ::fork();
        if (child == 0) judge_and_exit(k, count, judge, ends[1]);
        ::close(ends[1]);
        for (size_t size = 0; read_all(ends[0], &size, sizeof size);) {
            std::string problem(size, ' ');
            if (!read_all(ends[0], problem.data(), size)) break;
            found(k++, problem);
        }
        ::close(ends[0]);
        int status = 0;
        ::waitpid(child, &status, 0);
        if (k < count) found(k++, how_it_ended(status));
    }
}

struct Content {
    std::string bytes, trace;
};

void check_contents(const FileFormat& format, const Folder& folder, size_t count,
                    const std::function<Content(size_t)>& content) {
    const std::string path = folder.file("file." + format.extension);
    const auto judge = [&](size_t k) {
        const std::string bytes = content(k).bytes;
        std::ofstream(path, std::ios::binary) << bytes;
        return read_and_judge(format, path, bytes.size());
    };
    judge_apart(count, judge, [&](size_t k, const std::string& problem) {
        if (problem.empty()) return;
        const Content bad = content(k);
        SCOPED_TRACE(bad.trace);
        const std::string kept = folder.path().string() + "_failed." + format.extension;
        std::ofstream(kept, std::ios::binary) << bad.bytes;
        ADD_FAILURE() << problem << "\nthe file is kept as " << kept;
    });
}

void check_content(const FileFormat& format, const Folder& folder, const std::string& bytes) {
    check_contents(format, folder, 1, [&](size_t) { return Content{bytes, ""}; });
}

void check_path(const FileFormat& format, const std::string& path) {
    judge_apart(
        1, [&](size_t) { return read_and_judge(format, path, 0); },
        [](size_t, const std::string& problem) { EXPECT_EQ(problem, ""); });
}

void check_what_is_no_file(const FileFormat& format, const Folder& folder) {
    SCOPED_TRACE("no file, a folder, nothing in it");
    const std::string missing = folder.file("missing." + format.extension);
    EXPECT_THROW(format.load(missing), LoadError);
    check_path(format, missing);
    const std::string directory = folder.file("folder." + format.extension);
    fs::create_directories(directory);
    EXPECT_THROW(format.load(directory), LoadError);
    check_path(format, directory);
    check_content(format, folder, "");
    check_content(format, folder, std::string(1000, '\0'));
}

}  // namespace

void fuzz_files(const FileFormat& format) {
    const Folder folder;
    check_content(format, folder, format.sample);
    EXPECT_NO_THROW(format.load(folder.file("file." + format.extension))) << "the sample is valid";
    check_what_is_no_file(format, folder);
    check_contents(format, folder, 100, [&](size_t part) {
        return Content{format.sample.substr(0, part * format.sample.size() / 100),
                       "cut after " + std::to_string(part) + " %"};
    });
    const Seeds seeds = seeds_to_run(format.rounds);
    check_contents(format, folder, seeds.count, [&](size_t k) {
        const unsigned seed = seeds.first + static_cast<unsigned>(k);
        Random random(seed);
        return Content{mutated(format.sample, random), repeat_with(seed)};
    });
}

}  // namespace cloth::test
