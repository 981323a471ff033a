#include "demos/compare/options.h"

#include <gtest/gtest.h>

namespace cloth::options_test {

TEST(CompareOptions, DefaultsCompareTheShippedSolvers) {
    const CompareOptions options = parse_compare_options({});
    EXPECT_EQ(options.garment, "tshirt");
    EXPECT_EQ(options.frames, 90);
    EXPECT_EQ(options.solvers.size(), 8u);
}

TEST(CompareOptions, AWorkerGetsWhatItsParentWasTold) {
    const CompareOptions told =
        parse_compare_options({"--garment", "tshirt_1000", "--motion", "01_03", "--fabric", "real",
                               "--solvers", "fast+0,bullet", "--frames", "7", "--reference-frames",
                               "3", "--threads", "1", "--weights", "w", "--out", "o"});
    const CompareOptions heard = parse_compare_options(worker_arguments(told, "fast+0"));
    EXPECT_EQ(heard.worker, "fast+0");
    EXPECT_EQ(heard.garment, told.garment);
    EXPECT_EQ(heard.motion, told.motion);
    EXPECT_EQ(heard.fabric, told.fabric);
    EXPECT_EQ(heard.solvers, told.solvers);
    EXPECT_EQ(heard.frames, told.frames);
    EXPECT_EQ(heard.reference_frames, told.reference_frames);
    EXPECT_EQ(heard.threads, told.threads);
    EXPECT_EQ(heard.weights, told.weights);
    EXPECT_EQ(heard.out, told.out);
}

TEST(CompareOptions, RefusesWhatItDoesNotUnderstandByName) {
    const auto message = [](const std::vector<std::string>& arguments) -> std::string {
        try {
            parse_compare_options(arguments);
        } catch (const UsageError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message({"--frame", "3"}).find("--frame"), std::string::npos);
    EXPECT_NE(message({"--character", "dancer.glb"}).find("bake, viewer and hello_character"),
              std::string::npos);
    EXPECT_NE(message({"--frames", "three"}).find("three"), std::string::npos);
    EXPECT_NE(message({"--frames", "-1"}).find("-1"), std::string::npos);
    EXPECT_EQ(message({"--frames", "2.5"}).find("--frames 2.5: give a whole number from "), 0u);
    EXPECT_EQ(message({"--frames", "1e3"}).find("--frames 1e3: give a whole number from "), 0u);
    EXPECT_NE(message({"--frames"}).find("required"), std::string::npos);
    EXPECT_NE(message({"--fabric", "silk"}).find("silk"), std::string::npos);
    EXPECT_NE(message({"--solvers", ","}).find("--solvers"), std::string::npos);
    EXPECT_NE(message({"--help"}).find("--reference-frames"), std::string::npos);
}

}  // namespace cloth::options_test
