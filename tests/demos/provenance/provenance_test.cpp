#include "demos/provenance/provenance.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "data/core/read_file.h"

namespace cloth::provenance_test {

TEST(Provenance, SaysCommitMachineThreadsAndDate) {
    const nlohmann::ordered_json provenance = provenance_json(2);
    const auto matches = [&](const char* member, const char* pattern) {
        return std::regex_match(provenance.at(member).get<std::string>(), std::regex(pattern));
    };
    EXPECT_TRUE(matches("commit", "unknown|[0-9a-f]{10,}(-dirty)?")) << provenance;
    EXPECT_TRUE(matches("machine", ".+, [0-9]+ cores")) << provenance;
    EXPECT_TRUE(matches("date", "20[0-9]{2}-[01][0-9]-[0-3][0-9]")) << provenance;
    EXPECT_EQ(provenance.at("threads"), 2);
}

TEST(Provenance, SourcesOutsideGitAreOfNoKnownCommit) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "no_git";
    std::filesystem::create_directories(folder);
    const std::string command = "cmake -DSOURCE='" + folder.string() + "' -DOUTPUT='" +
                                (folder / "commit.cpp").string() +
                                "' -P '" CLOTH_SOURCE_DIR "/demos/provenance/commit.cmake'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_NE(read_file((folder / "commit.cpp").string()).find("return \"unknown\";"),
              std::string::npos);
}

}  // namespace cloth::provenance_test
