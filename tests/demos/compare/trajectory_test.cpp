#include "demos/compare/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "demos/compare/statistics.h"

namespace cloth::trajectory_test {

namespace {

std::string temporary(const std::string& name) {
    return ::testing::TempDir() + name;
}

Trajectory three_states() {
    Trajectory trajectory;
    for (int k = 0; k < 3; ++k)
        trajectory.push_back({Points::Constant(5, 3, 0.1 * k), Points::Random(5, 3), k / 30.0});
    return trajectory;
}

}  // namespace

TEST(Trajectory, ComesBackBitForBit) {
    const std::string path = temporary("whole.traj");
    const Trajectory written = three_states();
    save_trajectory(path, written);
    const Trajectory read = load_trajectory(path);
    ASSERT_EQ(read.size(), written.size());
    for (size_t k = 0; k < read.size(); ++k) {
        EXPECT_EQ(read[k].x, written[k].x);
        EXPECT_EQ(read[k].v, written[k].v);
        EXPECT_EQ(read[k].time, written[k].time);
    }
    EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST(Trajectory, BrokenFilesAreRefused) {
    const std::string path = temporary("broken.traj");
    EXPECT_THROW(load_trajectory(temporary("absent.traj")), LoadError);
    std::ofstream(path) << "not a trajectory, but long enough to hold a header";
    EXPECT_THROW(load_trajectory(path), LoadError);
    save_trajectory(path, three_states());
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 8);
    EXPECT_THROW(load_trajectory(path), LoadError);
}

TEST(Trajectory, CountsThatOverflowAreRefused) {
    const std::string path = temporary("overflow.traj");
    const std::uint64_t huge = std::uint64_t{1} << 61;
    // Both make the size of a file of the header and, in the first, one time.
    for (const auto& [states, vertices] : {std::pair<std::uint64_t, std::uint64_t>{1, huge},
                                           std::pair<std::uint64_t, std::uint64_t>{huge, 0}}) {
        std::ofstream file(path, std::ios::binary);
        file << "CLOTHTR1";
        file.write(reinterpret_cast<const char*>(&states), sizeof states);
        file.write(reinterpret_cast<const char*>(&vertices), sizeof vertices);
        if (vertices > 0) file.write("12345678", 8);
        file.close();
        EXPECT_THROW(load_trajectory(path), LoadError) << states << " " << vertices;
    }
}

TEST(Trajectory, RmseOfAShiftIsItsLength) {
    const Points a = Points::Random(10, 3);
    Points b = a;
    b.rowwise() += Vec3(0.003, 0, 0.004).transpose();
    EXPECT_NEAR(rmse_mm(a, b), 5.0, 1e-9);
}

TEST(Statistics, QuantilesInterpolateAndSkipUnknownValues) {
    const double none = std::nan("");
    EXPECT_DOUBLE_EQ(quantile({4, 1, none, 3, 2}, 0.5), 2.5);
    EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1.0), 4.0);
    EXPECT_DOUBLE_EQ(median({7}), 7.0);
    EXPECT_TRUE(std::isnan(median({})));
    EXPECT_TRUE(std::isnan(mean({})));
}

}  // namespace cloth::trajectory_test
