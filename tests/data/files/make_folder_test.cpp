#include "data/files/make_folder.h"

#include <unistd.h>

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
    if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    std::filesystem::permissions(
        path(""), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
    expect_load_error([&] { make_folder(path("")); }, path(""), "may not be written to");
    std::filesystem::permissions(path(""), std::filesystem::perms::owner_all);
}

}  // namespace cloth::make_folder_test
