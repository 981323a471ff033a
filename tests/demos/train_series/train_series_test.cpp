#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/train_series/child_process.h"
#include "demos/train_series/metrics_row.h"
#include "demos/train_series/series_run.h"
#include "render/replaced_file.h"
#include "tests/demos/train_series/stand_in_training.h"

namespace cloth::train_series_test {
namespace {

const char* const trains = R"(while [ $# -gt 0 ]; do
  case "$1" in --out) out="$2";; --iterations) n="$2";; --seed) seed="$2";; esac
  shift
done
touch "$out/checkpoint.pt"
printf 'iteration,gap,empty,stretch\n1,0.9,,1\n%s,0.%s,,1.25\n' "$n" "$seed" > "$out/metrics.csv"
)";

/// The program writes metrics that end with the iteration that it was asked for.
class TrainSeries : public test::StandInTraining {
 protected:
    void SetUp() override {
        StandInTraining::SetUp();
        m_settings.trainings = m_folder + "/trainings";
        m_settings.iterations = 7;
        m_settings.train = train();
        program(trains);
    }

    nlohmann::ordered_json run() {
        return run_series(m_series, m_settings, [](const std::string&) {});
    }

    SeriesSettings m_settings;
    TrainingSeries m_series{"test",
                            "a test",
                            {"--width", "16"},
                            5,
                            {{"one", "the first", {}}, {"two's own", "", {"--kicks", "0"}}}};
};

TEST_F(TrainSeries, EachTrainingIsRunWithEachSeed) {
    const nlohmann::ordered_json report = run();
    ASSERT_EQ(report.at("rows").size(), 4u);
    EXPECT_EQ(report.at("iterations"), 7);
    EXPECT_FALSE(report.at("provenance").at("commit").get<std::string>().empty());
    const nlohmann::ordered_json& last = report.at("rows").at(3);
    EXPECT_EQ(last.at("name"), "two's own");
    EXPECT_EQ(last.at("seed"), 2);
    EXPECT_EQ(last.at("arguments"), "--width 16 --kicks 0");
    EXPECT_EQ(last.at("iteration"), 7);
    EXPECT_EQ(last.at("gap"), 0.2);
    EXPECT_EQ(last.at("stretch"), 1.25);
    EXPECT_FALSE(last.contains("empty"));
    EXPECT_GT(last.at("peak_mb"), 0.1);
    EXPECT_GE(last.at("processor_s"), 0.0);
    EXPECT_NE(read_file(runs()).find("--width 16 --kicks 0 --seed 2 --iterations 7"),
              std::string::npos);
}

TEST_F(TrainSeries, WhatIsDoneIsNotTrainedAgain) {
    const nlohmann::ordered_json first = run();
    EXPECT_EQ(run(), first);
    EXPECT_EQ(run_count(), 4);
}

TEST_F(TrainSeries, OnlyTheNamedOnesAreTrained) {
    m_settings.only = {"one"};
    m_settings.seeds = {3};
    EXPECT_EQ(run().at("rows").size(), 1u);
    m_settings.only = {"three"};
    EXPECT_THROW(run(), ArgumentError);
}

TEST_F(TrainSeries, ATrainingOfOtherArgumentsIsNotTakenForThisOne) {
    run();
    m_series.arguments = {"--width", "32"};
    EXPECT_THROW(run(), LoadError);
    m_series.arguments = {"--width", "16"};
    m_settings.iterations = 8;
    EXPECT_THROW(run(), LoadError);
}

TEST_F(TrainSeries, AFailureNamesTheLogAndTheSameCommandGoesOn) {
    program("for last; do :; done; touch \"$last/checkpoint.pt\"; echo no luck; exit 3\n");
    m_settings.only = {"one"};
    m_settings.seeds = {1};
    try {
        run();
        FAIL() << "a failed training was taken for a finished one";
    } catch (const LoadError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("one_1/train.log"), std::string::npos) << text;
        EXPECT_NE(text.find("status 3"), std::string::npos) << text;
    }
    EXPECT_EQ(read_file(m_settings.trainings + "/test/one_1/train.log"), "no luck\n");
    program(trains);
    EXPECT_EQ(run().at("rows").at(0).at("processor_s"), nullptr) << "of its second half alone";
    EXPECT_NE(read_file(runs()).find("--resume"), std::string::npos);
}

TEST_F(TrainSeries, AProgramThatIsNotThereIsNamed) {
    EXPECT_THROW(run_child({m_folder + "/none"}, m_folder + "/log"), LoadError);
}

TEST_F(TrainSeries, TheLastCompleteRowCounts) {
    const std::string path = m_folder + "/metrics.csv";
    EXPECT_TRUE(last_metrics_row(path).empty());
    write_text_file(path, "iteration,loss\n");
    EXPECT_TRUE(last_metrics_row(path).empty());
    write_text_file(path, "iteration,loss\n1,-0.5\n2,-1.5\n3,-");
    EXPECT_EQ(last_metrics_row(path).dump(), R"({"iteration":2.0,"loss":-1.5})");
    write_text_file(path, "iteration,loss\n1,high\n");
    EXPECT_THROW(last_metrics_row(path), LoadError);
    write_text_file(path, "iteration,loss\n1\n");
    EXPECT_THROW(last_metrics_row(path), LoadError);
}

TEST_F(TrainSeries, AllCompleteRowsAreRead) {
    const std::string path = m_folder + "/metrics.csv";
    EXPECT_THROW(metrics_rows(path), LoadError) << "no such file";
    write_text_file(path, "iteration,loss\n1,-0.5\n2,\n3,-");
    const std::vector<nlohmann::ordered_json> rows = metrics_rows(path);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].dump(), R"({"iteration":1.0,"loss":-0.5})");
    EXPECT_EQ(rows[1].dump(), R"({"iteration":2.0})");
    write_text_file(path, "iteration,loss\n1,high\n2,1\n");
    EXPECT_THROW(metrics_rows(path), LoadError);
    write_text_file(path, "");
    EXPECT_TRUE(metrics_rows(path).empty());
}

TEST(TrainingSeriesNames, NeighboursAreOneToSeven) {
    const TrainingSeries& series = training_series("neighbours");
    ASSERT_EQ(series.trainings.size(), 7u);
    for (size_t k = 0; k < 7; ++k)
        EXPECT_EQ(series.trainings[k].arguments,
                  (std::vector<std::string>{"--sampled-edges", std::to_string(k + 1)}));
}

TEST(TrainingSeriesNames, AreUnique) {
    std::set<std::string> series;
    for (const TrainingSeries& one : training_series()) {
        EXPECT_TRUE(series.insert(one.name).second) << one.name;
        EXPECT_EQ(&training_series(one.name), &one);
        std::set<std::string> trainings;
        for (const SeriesTraining& training : one.trainings)
            EXPECT_TRUE(trainings.insert(training.name).second) << training.name;
    }
    EXPECT_THROW(training_series("none"), ArgumentError);
}

}  // namespace
}  // namespace cloth::train_series_test
