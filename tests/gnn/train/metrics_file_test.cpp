#include "gnn/train/metrics_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "data/core/errors.h"
#include "gnn/train/time_budget.h"

namespace cloth::metrics_file_test {
namespace {

std::string text_of(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

class MetricsFiles : public testing::Test {
 protected:
    const std::string m_path = testing::TempDir() + "metrics_file_" +
                               testing::UnitTest::GetInstance()->current_test_info()->name() +
                               ".csv";
    MetricsFile m_file{m_path, {"iteration", "loss"}};
};

TEST_F(MetricsFiles, ForgetRowsThatWillBeWrittenAgain) {
    m_file.keep_rows_up_to(0);
    for (const char* iteration : {"100", "200", "300"}) m_file.append({iteration, "0.5"});
    std::ofstream(m_path, std::ios::app) << "400,0.";  // killed while it was written
    m_file.keep_rows_up_to(200);
    EXPECT_EQ(text_of(m_path), "iteration,loss\n100,0.5\n200,0.5\n");
    m_file.keep_rows_up_to(0);
    EXPECT_EQ(text_of(m_path), "iteration,loss\n");
}

TEST_F(MetricsFiles, DropALineThatWasCutOff) {
    m_file.keep_rows_up_to(0);
    m_file.append({"100", "0.5"});
    std::ofstream(m_path, std::ios::app) << "200,0.";
    m_file.keep_rows_up_to(1000);
    EXPECT_EQ(text_of(m_path), "iteration,loss\n100,0.5\n");
}

TEST_F(MetricsFiles, RefuseOtherColumns) {
    m_file.keep_rows_up_to(0);
    EXPECT_THROW(MetricsFile(m_path, {"iteration", "gap"}).keep_rows_up_to(5), LoadError);
    EXPECT_THROW(MetricsFile("/no/such/folder/a.csv", {"a"}).keep_rows_up_to(0), LoadError);
}

TEST(MetricsCells, AreEmptyWithoutAValue) {
    EXPECT_EQ(cell(std::nan("")), "");
    EXPECT_EQ(cell(0.25), "0.25");
    EXPECT_EQ(cell(std::int64_t{1234567890}), "1234567890");
}

TEST(TimeBudget, KeepsToItsShareAndItsPause) {
    TimeBudget budget(0.1, 60.0, 1000.0);
    EXPECT_FALSE(budget.is_due(1059.0));
    EXPECT_TRUE(budget.is_due(1060.0));
    budget.spent(50.0, 1110.0);
    // Two of 50 s are a tenth of 1000 s.
    EXPECT_FALSE(budget.is_due(1940.0));
    EXPECT_TRUE(budget.is_due(1951.0));
    budget.spent(1.0, 1952.0);
    EXPECT_FALSE(budget.is_due(1953.0)) << "the pause";
    EXPECT_TRUE(budget.is_due(2012.0));
    EXPECT_DOUBLE_EQ(budget.total(), 51.0);
}

TEST(TimeBudget, NeverSpendsMoreThanItsShareWhereCostsAreSteady) {
    TimeBudget budget(0.1, 1.0, 0.0);
    double now = 30.0, validated = 0.0;
    for (int k = 0; k < 2000; ++k, now += 1.0) {
        if (!budget.is_due(now)) continue;
        now += 3.0;
        validated += 3.0;
        budget.spent(3.0, now);
        EXPECT_LE(validated, 0.1 * now + 1e-9);
    }
    EXPECT_GT(validated, 0.09 * now);
}

TEST(TimeBudget, ShareOfNothingIsNever) {
    EXPECT_FALSE(TimeBudget(0.0, 0.0, 0.0).is_due(1e9));
}

}  // namespace
}  // namespace cloth::metrics_file_test
