#include "collision/geometry/select_rows.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <random>

namespace cloth::select_rows_test {
namespace {

TEST(SelectRows, FindsWhatALoopFindsOnAnyNumberOfThreads) {
    std::mt19937 random(3);
    const int threads = omp_get_max_threads();
    std::vector<char> scratch;
    for (int trial = 0; trial < 60; ++trial) {
        omp_set_num_threads(1 + trial % 3);
        const int first = int(random() % 50), last = first + int(random() % 3000);
        std::vector<char> chosen(static_cast<size_t>(last));
        for (char& one : chosen) one = random() % 4 == 0;
        std::vector<int> expected, thirds, found = {7, 7, 7}, kept;
        for (int i = first; i < last; ++i) {
            if (chosen[static_cast<size_t>(i)]) expected.push_back(i);
            if (chosen[static_cast<size_t>(i)] && i % 3 == 0) thirds.push_back(i);
        }
        const auto is_chosen = [&](int i) { return chosen[static_cast<size_t>(i)] != 0; };
        select_rows(first, last, 500, scratch, found, is_chosen);
        EXPECT_EQ(found, expected);
        keep_rows(100, scratch, found, [](int i) { return i % 3 == 0; });
        EXPECT_EQ(found, thirds);
    }
    omp_set_num_threads(threads);
}

TEST(SelectRows, OfNoneThereAreNone) {
    std::vector<char> scratch;
    std::vector<int> rows = {1, 2};
    select_rows(5, 5, 1, scratch, rows, [](int) { return true; });
    EXPECT_TRUE(rows.empty());
    keep_rows(1, scratch, rows, [](int) { return true; });
    EXPECT_TRUE(rows.empty());
}

}  // namespace
}  // namespace cloth::select_rows_test
