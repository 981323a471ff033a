// Rows that are kept, and rows that are not.

#include <gtest/gtest.h>

#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/paper_tables/paper_report.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth::paper_report_test {

namespace {

using Json = PaperReport::Json;

Json row_of(const std::string& solver, const std::string& key, double fps) {
    return {{"garment", "tshirt"}, {"solver", solver}, {"key", key}, {"fps", fps}};
}

class Report : public ::testing::Test {
 protected:
    void SetUp() override {
        m_folder = ::testing::TempDir() + "paper_report_" +
                   ::testing::UnitTest::GetInstance()->current_test_info()->name();
        std::filesystem::remove_all(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    std::string file() const { return m_folder + "/paper_tables.json"; }
    std::string refusal(const std::string& text) const {
        std::filesystem::create_directories(m_folder);
        write_text_file(file(), text);
        try {
            PaperReport(m_folder, 1, false);
        } catch (const LoadError& error) {
            return error.what();
        }
        return "";
    }

    std::string m_folder;
};

}  // namespace

TEST_F(Report, GoesOnWithTheRowsOfItsFile) {
    {
        PaperReport report(m_folder, 1, false);
        report.put("rows", row_of("a", "30 frames", 1));
        report.put("rows", row_of("b", "30 frames", 2));
        report.put("training", {{"network", "fast"}, {"key", "k"}});
    }
    PaperReport report(m_folder, 1, false);
    EXPECT_TRUE(report.has("rows", row_of("a", "", 0), "30 frames"));
    EXPECT_FALSE(report.has("rows", row_of("a", "", 0), "20 frames"));
    EXPECT_FALSE(report.has("rows", row_of("c", "", 0), "30 frames"));
    EXPECT_TRUE(report.has("training", {{"network", "fast"}}, "k"));
    EXPECT_FALSE(report.has("training", {{"network", "hood"}}, "k"));
    report.put("rows", row_of("a", "20 frames", 3));
    const Json saved = Json::parse(read_file(file()));
    ASSERT_EQ(saved.at("rows").size(), 2u) << "one row of a solver and garment";
    EXPECT_EQ(saved.at("rows")[0].at("fps"), 3);
    EXPECT_EQ(saved.at("rows")[0].at("commit"), build_commit());
    EXPECT_EQ(saved.at("provenance").at("threads"), 1);
}

TEST_F(Report, BeginsAfreshIfAskedTo) {
    PaperReport(m_folder, 1, false).put("rows", row_of("a", "k", 1));
    EXPECT_TRUE(PaperReport(m_folder, 1, true).document().at("rows").empty());
    write_text_file(file(), "{");
    EXPECT_NO_THROW(PaperReport(m_folder, 1, true)) << "what is damaged is not read";
}

TEST_F(Report, RowsAreArrangedAndNoneIsLost) {
    PaperReport report(m_folder, 1, false);
    for (const char* solver : {"c", "a", "d", "b"}) report.put("rows", row_of(solver, "k", 1));
    report.arrange("rows", {row_of("a", "", 0), row_of("none", "", 0), row_of("b", "", 0)});
    std::string order;
    for (const Json& row : report.document().at("rows"))
        order += row.at("solver").get<std::string>();
    EXPECT_EQ(order, "abcd");
}

TEST_F(Report, RowsOfAnotherCommitAreLeftOut) {
    PaperReport(m_folder, 1, false).put("rows", row_of("a", "k", 1));
    Json saved = Json::parse(read_file(file()));
    saved["rows"][0]["commit"] = "0123456789";
    write_text_file(file(), saved.dump());
    EXPECT_TRUE(PaperReport(m_folder, 1, false).document().at("rows").empty());
}

TEST_F(Report, ADamagedFileIsNamedWithTheRemedy) {
    const std::string remedy = "Remedy: delete it, or give --again";
    for (const char* text : {"", "{\"rows\": [", "[]", "{\"rows\": 3}", "{\"rows\": [1]}",
                             "{\"rows\": [{\"key\": \"k\"}]}", "{\"training\": [{\"key\": 1}]}"}) {
        const std::string message = refusal(text);
        EXPECT_EQ(message.rfind(file(), 0), 0u) << text << ": " << message;
        EXPECT_NE(message.find(remedy), std::string::npos) << message;
    }
    EXPECT_EQ(refusal("{}"), "");
}

}  // namespace cloth::paper_report_test
