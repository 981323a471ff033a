#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "data/core/errors.h"

namespace cloth::test {

/// A folder of its own for each test, gone afterwards.
class FileTest : public testing::Test {
 protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        m_folder = std::filesystem::temp_directory_path() /
                   (std::string(info->test_suite_name()) + "_" + info->name());
        std::filesystem::create_directories(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    std::string path(const std::string& name) const { return (m_folder / name).string(); }

    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }

 private:
    std::filesystem::path m_folder;
};

/// Expects `load()` to throw a LoadError that names the file, the place or problem, and a remedy.
template <typename Load>
void expect_load_error(const Load& load, const std::string& file, const std::string& part) {
    std::string message = "no error";
    try {
        load();
    } catch (const LoadError& error) {
        message = error.what();
    }
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
    EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
}

}  // namespace cloth::test
