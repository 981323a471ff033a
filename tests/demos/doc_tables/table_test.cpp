// Tables from data, and their measurement.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/doc_tables/measure.h"
#include "demos/doc_tables/registry.h"

namespace cloth::table_test {

namespace fs = std::filesystem;

namespace {

/// One column: the price of each shoe.
MarkdownTable prices(const std::vector<DataFile>& files) {
    MarkdownTable table{{"shoe", "price"}, {}};
    for (const DataRow& row : files.at(0).rows("shoes"))
        table.rows.push_back({row.text("/name"), decimals(row.number("/price"), 1)});
    return table;
}

const char* const known = R"("commit": "0123456789", "machine": "a loom", "threads": 2,
                             "date": "2026-12-31")";

/// A folder of sources with one page, one data set and a program that measures it.
class Shop : public ::testing::Test {
 protected:
    void SetUp() override {
        root = fs::path(::testing::TempDir()) /
               (std::string("doc_tables_") +
                ::testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(root);
        fs::create_directories(root / "data");
        fs::create_directories(root / "guide");
        registry.data_sets = {
            {"shoes", "data/shoes.json", "cp new.json OUT/report.json", "report.json", {}, {}}};
        registry.tables = {{"prices", {"shoes"}, prices}};
    }
    void write(const std::string& file, const std::string& text) {
        std::ofstream(root / file) << text;
    }
    void write_shoes(const std::string& shoes, const std::string& provenance = known) {
        write("data/shoes.json",
              "{\"provenance\": {" + provenance + "}, \"shoes\": " + shoes + "}");
    }
    std::string text() const {
        return table_text(registry, registry.tables[0], root.string(),
                          (root / "guide/page.md").string());
    }
    std::string refusal() const {
        try {
            return "no error, but " + text();
        } catch (const LoadError& error) {
            return error.what();
        }
    }

    fs::path root;
    Registry registry;
};

}  // namespace

TEST(Markdown, NumbersAreRounded) {
    EXPECT_EQ(decimals(-0.04, 1), "0.0");
    EXPECT_EQ(decimals(2.25, 0), "2");
    EXPECT_EQ(decimals(std::nan(""), 1), "–");
    EXPECT_EQ(significant(0.04213, 3), "0.0421");
    EXPECT_EQ(significant(15.49, 3), "15.5");
    EXPECT_EQ(significant(423.0, 2), "420");
    EXPECT_EQ(significant(9.96, 2), "10");
    EXPECT_EQ(significant(-3.14159, 2), "-3.1");
    EXPECT_EQ(significant(4.9e-6, 2), "4.9e-06");
    EXPECT_EQ(significant(0.0, 2), "0");
    EXPECT_EQ(scientific(0.0017), "1.7e-03");
    EXPECT_EQ(scientific(0.0), "0");
}

TEST(Markdown, EveryRowHasACellForEachColumn) {
    EXPECT_EQ(to_markdown({{"a", "b"}, {{"1", "x|y"}}}), "| a | b |\n|---|---|\n| 1 | x\\|y |");
    EXPECT_THROW(to_markdown({{"a", "b"}, {{"1"}}}), ArgumentError);
}

TEST_F(Shop, ATableSaysWhereItsFiguresAreFrom) {
    write_shoes(R"([{"name": "boot", "price": 12.34}, {"name": "clog", "price": null}])");
    EXPECT_EQ(text(),
              "| shoe | price |\n|---|---|\n| boot | 12.3 |\n| clog | – |\n\n"
              "Measured: [shoes.json](../data/shoes.json), commit 0123456789; machine a loom; "
              "threads 2; date 2026-12-31. Again: `build/release/demos/doc_tables --measure "
              "shoes`.");
}

TEST_F(Shop, WhatNobodyRecordedIsSaidToBeSo) {
    write_shoes("[]", R"("commit": null, "committed_in": "commit abc", "machine": "a loom",
                        "threads": null, "date": null, "note": "It rained.")");
    EXPECT_NE(text().find("commit not recorded (the file is of commit abc); machine a loom; "
                          "threads not recorded; date not recorded. It rained. Again"),
              std::string::npos)
        << text();
}

TEST_F(Shop, WhatTheDataHaveNotIsNamed) {
    const std::string file = (root / "data/shoes.json").string();
    EXPECT_NE(refusal().find(file), std::string::npos) << "no file: " << refusal();
    write("data/shoes.json", "{");
    EXPECT_NE(refusal().find("is not a JSON object"), std::string::npos) << refusal();
    write("data/shoes.json", "{\"provenance\": {" + std::string(known) + "}}");
    EXPECT_NE(refusal().find(file + ": has no list \"shoes\""), std::string::npos) << refusal();
    write_shoes(R"([{"name": "boot", "price": 1}, {"name": "clog"}])");
    EXPECT_NE(refusal().find(file + ", shoes[1]: has no /price. Remedy: measure it again"),
              std::string::npos)
        << refusal();
    write_shoes(R"([{"name": "boot", "price": "much"}])");
    EXPECT_NE(refusal().find("/price is no number"), std::string::npos) << refusal();
    write_shoes("[]", R"("commit": "0123456789")");
    EXPECT_NE(refusal().find("provenance: has no machine"), std::string::npos) << refusal();
}

TEST_F(Shop, ARowIsFoundByItsMembersOrMissed) {
    write_shoes(R"([{"name": "boot", "price": 1}, {"name": "clog", "price": 2}])");
    const DataFile file = DataFile::load((root / "data/shoes.json").string());
    EXPECT_EQ(file.row("shoes", {{"name", "clog"}}).number("/price"), 2.0);
    try {
        file.row("shoes", {{"name", "sandal"}});
        FAIL() << "there is no sandal";
    } catch (const LoadError& error) {
        EXPECT_NE(std::string(error.what()).find("shoes with name sandal: there is none"),
                  std::string::npos)
            << error.what();
    }
}

TEST_F(Shop, MeasuringReplacesTheFileOrLeavesItAsItWas) {
    write_shoes("[]");
    const std::string before = read_file((root / "data/shoes.json").string());
    EXPECT_THROW(measure(registry.data_sets[0], root.string(), "bin"), LoadError) << "no new.json";
    EXPECT_EQ(read_file((root / "data/shoes.json").string()), before);
    write("new.json", R"({"shoes": [{"name": "boot", "price": 3}]})");
    registry.data_sets[0].tidy = [](const nlohmann::ordered_json& report) {
        nlohmann::ordered_json tidy = {
            {"provenance", nlohmann::ordered_json::parse("{" + std::string(known) + "}")}};
        tidy.update(report);
        return tidy;
    };
    measure(registry.data_sets[0], root.string(), "bin");
    EXPECT_NE(text().find("| boot | 3.0 |"), std::string::npos) << text();
}

TEST_F(Shop, ProgramsAreThoseOfTheGivenBuild) {
    fs::create_directories(root / "a build");
    write("a build/program", "#!/bin/sh\necho '{\"shoes\": []}' > \"$1/report.json\"\n");
    fs::permissions(root / "a build/program", fs::perms::owner_all);
    registry.data_sets[0].command = "build/release/program OUT";
    measure(registry.data_sets[0], root.string(), (root / "a build").string());
    EXPECT_EQ(read_file((root / "data/shoes.json").string()), "{\n \"shoes\": []\n}\n");
}

TEST(Registry, EveryTableHasItsDataSetsAndNoNameIsUsedTwice) {
    const Registry& registry = doc_registry();
    std::vector<std::string> names;
    for (const DocTable& table : registry.tables) {
        names.push_back(table.name);
        for (const std::string& name : table.data) EXPECT_NO_THROW(registry.data_set(name));
    }
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    EXPECT_THROW(registry.data_set("shoes"), ArgumentError);
    EXPECT_EQ(registry.find_table("shoes"), nullptr);
}

TEST(Registry, EveryTableIsMadeFromTheCommittedData) {
    const fs::path root = CLOTH_SOURCE_DIR;
    const Registry& registry = doc_registry();
    int made = 0;
    for (const DocTable& table : registry.tables) {
        const bool committed =
            std::all_of(table.data.begin(), table.data.end(), [&](const std::string& name) {
                return fs::exists(root / registry.data_set(name).file);
            });
        if (!committed) continue;
        ++made;
        EXPECT_NO_THROW(table_text(registry, table, root.string(), (root / "README.md").string()))
            << table.name;
    }
    EXPECT_GE(made, 11);
}

TEST(Registry, SelfContactIsTheBenchmarksMedians) {
    const Registry& registry = doc_registry();
    const auto row = [](const std::string& name, const char* kind, double cpu) {
        return nlohmann::ordered_json{{"name", name + "_" + kind}, {"run_name", name},
                                      {"run_type", "aggregate"},   {"aggregate_name", kind},
                                      {"cpu_time", cpu},           {"iterations", 3}};
    };
    nlohmann::ordered_json report = {{"context",
                                      {{"date", "2026-12-31T23:59:00+00:00"},
                                       {"host_name", "secret"},
                                       {"commit", "0123456789"},
                                       {"machine", "a loom"},
                                       {"threads", "1"}}}};
    double cpu = 1.0;
    for (const char* meets : {"0", "1"})
        for (const char* vertices : {"1000", "4000"})
            for (const char* with : {"0", "1"}) {
                const std::string name = std::string("step/meets:") + meets +
                                         "/vertices:" + vertices + "/self_contact:" + with;
                report["benchmarks"].push_back(row(name, "mean", 99.0));
                report["benchmarks"].push_back(row(name, "median", cpu++));
            }
    const nlohmann::ordered_json tidy = registry.data_set("self_contact").tidy(report);
    EXPECT_EQ(tidy.at("provenance").at("date"), "2026-12-31");
    EXPECT_EQ(tidy.dump().find("secret"), std::string::npos);
    const MarkdownTable table =
        registry.find_table("self_contact")->make({DataFile("report.json", tidy)});
    ASSERT_EQ(table.rows.size(), 4u);
    EXPECT_EQ(table.rows[3], (std::vector<std::string>{"folded in half", "4000", "7.0", "8.0"}));
}

}  // namespace cloth::table_test
