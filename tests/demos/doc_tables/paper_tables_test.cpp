// The paper's figures beside ours, on a report of known numbers.

#include "demos/doc_tables/paper_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data/core/errors.h"
#include "demos/doc_tables/paper_data.h"

namespace cloth::paper_tables_test {

namespace {

using Json = nlohmann::ordered_json;

Json row(const std::string& garment, const std::string& solver, double fps, double memory,
         double loss) {
    return {{"garment", garment},
            {"solver", solver},
            {"fps", fps},
            {"memory_mb", memory},
            {"network_mb", nullptr},
            {"network_ms", 500 / fps},
            {"loss",
             {{"strain", loss / 2},
              {"bending", 1},
              {"contact", 1},
              {"gravity", 1},
              {"inertia", 1},
              {"friction", 1},
              {"total", loss}}},
            {"gap_median", 0.25},
            {"fine_rmse_mm", 12.3},
            {"failure", nullptr},
            {"first_failed_frame", nullptr}};
}

Json training(const std::string& network, double cost, double memory, const Json& history) {
    return {{"network", network}, {"iterations", 3000}, {"gap_tshirt", 0.2},
            {"gap_sheet", 0.3},   {"history", history}, {"s_per_iteration", cost},
            {"peak_mb", memory}};
}

/// `fast` is twice as fast as the baseline, needs as much memory, and has 1.5 times the loss; HOOD
/// is not trained.
Json report() {
    Json json = {{"rows", Json::array()},
                 {"training",
                  {training("smallest", 0.01, 100, Json::array()),
                   training("baseline", 0.2, 300, {{1000, 0.5}, {2000, 0.3}, {3000, 0.1}}),
                   training("fast", 0.1, 180, {{1000, 0.4}, {2000, 0.25}, {3000, 0.2}})}},
                 {"neighbours", Json::array()}};
    for (const char* garment : {"tshirt", "pants", "dress"}) {
        json["rows"].push_back(row(garment, "baseline+0", 10, 50, 2));
        json["rows"].push_back(row(garment, "fast+0", 20, 50, 3));
        json["rows"].push_back({{"garment", garment},
                                {"solver", "hood+0"},
                                {"missing", "not trained yet: no hood.safetensors"}});
    }
    for (int count = 1; count <= 7; ++count)
        for (double seed : {-0.01, 0.01})
            json["neighbours"].push_back(
                {{"name", std::to_string(count)}, {"gap_tshirt_median", 0.2 + 0.1 / count + seed}});
    return json;
}

std::vector<std::string> row_named(const MarkdownTable& table, const std::string& name) {
    for (const auto& cells : table.rows)
        if (cells.at(0).find(name) != std::string::npos) return cells;
    return {};
}

}  // namespace

TEST(PaperData, TakesMeansAndThresholds) {
    const DataFile file("report.json", report());
    const PaperData data(file);
    EXPECT_EQ(data.number("tshirt", "fast+0", "/fps"), 20.0);
    EXPECT_TRUE(std::isnan(data.number("tshirt", "hood+0", "/fps")));
    EXPECT_TRUE(std::isnan(data.number("tshirt", "bistride+0", "/fps")));
    EXPECT_EQ(data.missing("tshirt", "hood+0"), "not trained yet: no hood.safetensors");
    EXPECT_EQ(data.common_gap(), 0.2) << "fast reached no less";
    EXPECT_EQ(data.iterations_to("baseline", 0.2), 3000.0);
    EXPECT_EQ(data.iterations_to("baseline", 0.5), 1000.0);
    EXPECT_TRUE(std::isnan(data.iterations_to("fast", 0.1)));
    EXPECT_NEAR(data.neighbours(2, "gap_tshirt_median"), 0.25, 1e-12);
    EXPECT_EQ(data.neighbour_seeds(2), 2);
    EXPECT_TRUE(std::isnan(data.neighbours(8, "gap_tshirt_median")));
}

TEST(PaperData, AReportWithoutItsListsIsRefused) {
    for (const char* list : {"rows", "training", "neighbours"}) {
        Json json = report();
        json.erase(list);
        const DataFile file("report.json", json);
        EXPECT_THROW(PaperData{file}, LoadError) << list;
    }
}

TEST(PaperTables, FiguresStandBesideThoseOfThePaper) {
    const std::vector<DataFile> files = {DataFile("report.json", report())};
    const MarkdownTable tshirt = paper_garment_table(files, "tshirt");
    EXPECT_EQ(row_named(tshirt, "fast+0"),
              (std::vector<std::string>{"fast+0", "39.2", "20.0", "40.0", "373", "50", "–", "0.461",
                                        "3.00", "0.25", "12", "–"}));
    EXPECT_EQ(row_named(tshirt, "hood+0").back(), "not trained yet: no hood.safetensors");
    const std::vector<std::string> fast = row_named(paper_training_table(files), "fast");
    EXPECT_EQ(fast[1], "30");
    EXPECT_EQ(fast[2], "0.083") << "3000 iterations of 0.1 s";
    EXPECT_EQ(fast[4], "3000");
    EXPECT_EQ(row_named(paper_training_table(files), "baseline")[3], "0.17");
    EXPECT_EQ(row_named(paper_hood_table(files), "paper"),
              (std::vector<std::string>{"paper", "1.75", "–", "0.57", "–", "1.05", "–", "–"}));
    EXPECT_EQ(row_named(paper_hood_table(files), "tshirt, +0")[1], "–");
    EXPECT_EQ(paper_neighbours_table(files).rows[1][2], "0.250");
    EXPECT_EQ(row_named(paper_terms_table(files), "fast+0")[1], "1.50");
}

TEST(PaperTables, ClaimsHoldOrNotByTheFigures) {
    const MarkdownTable claims = paper_claims_table({DataFile("report.json", report())});
    const auto claim = [&](const std::string& name) { return row_named(claims, name); };
    EXPECT_EQ(claim("fast over baseline: frames per second"),
              (std::vector<std::string>{"fast over baseline: frames per second",
                                        "1.79 / 1.72 / 1.88", "2.00 / 2.00 / 2.00", "yes"}));
    EXPECT_EQ(claim("fast over baseline: evaluations")[2], "2.00 / 2.00 / 2.00");
    EXPECT_EQ(claim("fast over baseline: memory").back(), "no");
    EXPECT_EQ(claim("fast over baseline: loss").back(), "no");
    EXPECT_EQ(claim("sampling over baseline: loss").back(), "not measured");
    EXPECT_EQ(claim("HOOD + ours over HOOD: frames").back(), "not measured");
    EXPECT_EQ(claim("fast over baseline: time of a training iteration"),
              (std::vector<std::string>{"fast over baseline: time of a training iteration", "0.57",
                                        "0.50", "yes"}));
    EXPECT_EQ(claim("fast over baseline: memory of training")[2], "0.40");
    EXPECT_EQ(claim("fast: frames per second").back(), "in part") << "the dress's";
    EXPECT_EQ(claim("strain is slightly higher")[2], "1.50");
    EXPECT_EQ(claim("strain is slightly higher").back(), "no");
    EXPECT_EQ(claim("other terms").back(), "yes");
    EXPECT_EQ(claim("more sampled neighbours").back(), "yes");
    EXPECT_EQ(claim("from 4 neighbours on").back(), "yes");
}

TEST(PaperTables, AHalvedGainIsLessThanInThePaper) {
    Json json = report();
    for (Json& one : json["rows"])
        if (one.at("solver") == "fast+0") one["fps"] = 13;
    const MarkdownTable claims = paper_claims_table({DataFile("report.json", json)});
    EXPECT_EQ(row_named(claims, "fast over baseline: frames").back(), "less than in the paper");
}

}  // namespace cloth::paper_tables_test
