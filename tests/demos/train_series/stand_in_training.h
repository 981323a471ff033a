#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "data/core/read_file.h"
#include "render/replaced_file.h"

namespace cloth::test {

/// A folder of its own for each test, with a program that stands for `train` and notes its
/// arguments.
class StandInTraining : public ::testing::Test {
 protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        m_folder = ::testing::TempDir() + test->test_suite_name() + "_" + test->name();
        std::filesystem::remove_all(m_folder);
        std::filesystem::create_directories(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    /// @param text  of a shell script
    void program(const std::string& text) const {
        write_text_file(train(), "#!/bin/sh\necho \"$*\" >> '" + runs() + "'\n" + text);
        std::filesystem::permissions(train(), std::filesystem::perms::owner_all);
    }
    std::string train() const { return m_folder + "/train"; }
    std::string runs() const { return m_folder + "/runs"; }  ///< a line for each
    int run_count() const {
        const std::string text = read_file(runs());
        return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    }

    std::string m_folder;
};

}  // namespace cloth::test
