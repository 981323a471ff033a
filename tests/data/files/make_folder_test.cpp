#include "data/files/make_folder.h"

#include <unistd.h>

#include <cstdio>

#include "tests/data/files/file_fixture.h"

namespace cloth::make_folder_test {

using namespace test;

using MakeFolder = FileTest;

TEST_F(MakeFolder, FoldersAboveItAreMadeToo) {
    for (int again = 0; again < 2; ++again) make_folder(path("a/b/c"));
    make_folder(path("d/"));
    EXPECT_TRUE(std::filesystem::is_directory(path("a/b/c")));
    EXPECT_TRUE(std::filesystem::is_directory(path("d")));
}

TEST_F(MakeFolder, WhatIsAFileOrBelowOneIsRefused) {
    write("file", "");
    for (const std::string name : {"file", "file/a/b"})
        expect_load_error([&] { make_folder(path(name)); }, path(name),
                          "the folder cannot be made (Not a directory)");
    expect_load_error([&] { make_folder("/proc/none"); }, "/proc/none", "cannot be made");
}

TEST_F(MakeFolder, OneThatMayNotBeWrittenToIsRefused) {
    constexpr uid_t kNobody = 65534;  // root may write everywhere
    const auto try_it = [&] {
        if (geteuid() == 0 && setuid(kNobody) != 0) _exit(2);
        try {
            make_folder(path(""));
        } catch (const LoadError& error) {
            std::fputs(error.what(), stderr);
            _exit(0);
        }
        _exit(1);
    };
    std::filesystem::permissions(
        path(""), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    EXPECT_EXIT(try_it(), testing::ExitedWithCode(0), path("") + ".*may not be written to");
    std::filesystem::permissions(path(""), std::filesystem::perms::owner_all);
}

}  // namespace cloth::make_folder_test
