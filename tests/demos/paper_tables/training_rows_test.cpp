// What metrics tell, and what short trainings cost.

#include "demos/paper_tables/training_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "render/replaced_file.h"
#include "tests/demos/train_series/stand_in_training.h"

namespace cloth::paper_training_rows_test {

namespace {

using Json = nlohmann::ordered_json;

const auto quiet = [](int, int, const std::string&) {};

class TrainingRows : public test::StandInTraining {
 protected:
    void SetUp() override {
        StandInTraining::SetUp();
        m_settings.weights = m_folder;
        m_settings.train = train();
        m_settings.work = m_folder + "/trainings";
        m_settings.iterations = 40;
    }

    void metrics(const std::string& rows) {
        write_text_file(
            m_folder + "/fast.csv",
            "iteration,gap_training_median,gap_tshirt_median,gap_sheet_median\n" + rows);
    }

    TrainingRowSettings m_settings;
};

}  // namespace

TEST_F(TrainingRows, AHistoryIsTheMeanOverFiveRows) {
    metrics("10,1,,\n20,2,,\n30,3,0.5,0.75\n40,4,,\n50,5,,\n60,11,,\n");
    const Json history = training_history(m_folder + "/fast.csv");
    EXPECT_EQ(history.at("iterations"), 60);
    EXPECT_EQ(history.at("gap_tshirt"), 0.5) << "of the last validation";
    EXPECT_EQ(history.at("gap_sheet"), 0.75);
    EXPECT_EQ(history.at("history").dump(), "[[50,3.0],[60,5.0]]");
}

TEST_F(TrainingRows, RowsInWhichNoGapWasMeasuredDoNotCount) {
    metrics("10,1,,\n20,2,,\n30,3,0.5,0.75\n40,,,\n50,4,,\n60,5,,\n70,,,\n");
    const Json history = training_history(m_folder + "/fast.csv");
    EXPECT_EQ(history.at("iterations"), 70);
    EXPECT_EQ(history.at("history").dump(), "[[60,3.0]]");
}

TEST_F(TrainingRows, MetricsThatCannotBeUsedAreNamed) {
    EXPECT_TRUE(training_history(m_folder + "/none.csv").is_null());
    metrics("10,,,\n");
    EXPECT_THROW(training_history(m_folder + "/fast.csv"), LoadError);
    metrics("10,high,,\n");
    EXPECT_THROW(training_history(m_folder + "/fast.csv"), LoadError);
}

TEST_F(TrainingRows, EachNetworkIsTrainedTwiceAndOnce) {
    program("exit 0\n");
    metrics("10,1,,\n");
    PaperReport report(m_folder, 1, false);
    measure_trainings({"fast", "hood"}, m_settings, report, quiet);
    EXPECT_EQ(run_count(), 6) << "with the smallest";
    const std::string text = read_file(runs());
    EXPECT_NE(text.find("--variant fast --width 32 --steps 21 --iterations 10 "), std::string::npos)
        << text;
    EXPECT_NE(text.find("--variant hood --width 32 --steps 15 --iterations 40 "), std::string::npos)
        << text;
    const Json& rows = report.document().at("training");
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0].at("network"), "smallest");
    EXPECT_EQ(rows[1].at("iterations"), 10);
    EXPECT_TRUE(rows[2].at("iterations").is_null()) << "hood has no metrics";
    EXPECT_GT(rows[2].at("peak_mb"), 0.1);
    EXPECT_TRUE(rows[2].at("s_per_iteration").is_number());

    PaperReport again(m_folder, 1, false);
    measure_trainings({"fast", "hood"}, m_settings, again, quiet);
    EXPECT_EQ(run_count(), 6) << "what is measured is kept";
    metrics("10,1,,\n20,1,,\n");
    measure_trainings({"fast", "hood"}, m_settings, again, quiet);
    EXPECT_EQ(run_count(), 8) << "fast has other metrics";
}

TEST_F(TrainingRows, WithoutTheProgramThereIsNoCost) {
    m_settings.train = m_folder + "/none";
    PaperReport report(m_folder, 1, false);
    measure_trainings({"fast"}, m_settings, report, quiet);
    EXPECT_TRUE(report.document().at("training")[1].at("s_per_iteration").is_null());
}

TEST_F(TrainingRows, AFailureNamesTheLog) {
    program("echo no luck; exit 3\n");
    PaperReport report(m_folder, 1, false);
    try {
        measure_trainings({"fast"}, m_settings, report, quiet);
        FAIL() << "a failed training was taken for a finished one";
    } catch (const LoadError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("smallest_10/train.log: the training ended with status 3"),
                  std::string::npos)
            << text;
    }
}

}  // namespace cloth::paper_training_rows_test
