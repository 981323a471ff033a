#include "render/replaced_file.h"

#include <gtest/gtest.h>

#include <csignal>

#include "tests/render/temporary_folder.h"

namespace cloth::test {
namespace {

TEST(ReplacedFile, ASignalThatEndsTheProgramLeavesNothing) {
    const TemporaryFolder folder;
    folder.write("film.mp4", "old");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto end = [&] {
            std::signal(signal, SIG_DFL);
            remove_temporary_files_at_signals();
            const ReplacedFile film(folder.file("film.mp4")), other(folder.file("other"));
            { const ReplacedFile ended(folder.file("ended")); }
            for (const ReplacedFile* file : {&film, &other})
                std::ofstream(file->temporary_path()) << "half";
            std::raise(signal);
        };
        EXPECT_EXIT(end(), ::testing::KilledBySignal(signal), "");
        EXPECT_EQ(folder.file_count(), 1u) << signal;
    }
    EXPECT_EQ(content_of(folder.file("film.mp4")), "old");
}

TEST(ReplacedFile, SignalsThatAreIgnoredStaySo) {
    const auto go_on = [] {
        std::signal(SIGHUP, SIG_IGN);
        remove_temporary_files_at_signals();
        std::raise(SIGHUP);
        std::exit(3);
    };
    EXPECT_EXIT(go_on(), ::testing::ExitedWithCode(3), "");
}

}  // namespace
}  // namespace cloth::test
