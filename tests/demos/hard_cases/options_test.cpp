#include "demos/hard_cases/options.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "data/core/errors.h"
#include "demos/compare/arguments.h"
#include "demos/hard_cases/contest.h"
#include "demos/hard_cases/motion_cases.h"

namespace cloth::options_test {

namespace {

std::string message(const std::function<void()>& action) {
    try {
        action();
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(HardCaseOptions, AllCasesByDefault) {
    const HardCaseOptions options = parse_hard_case_options({});
    EXPECT_EQ(options.cases.size(), hard_cases().size());
    EXPECT_EQ(options.steppers, default_hard_case_steppers());
    EXPECT_TRUE(options.pictures);
}

TEST(HardCaseOptions, AreRead) {
    const HardCaseOptions options = parse_hard_case_options(
        {"--cases", "teleport,needles", "--steppers", "fast", "--frames-scale", "0.5", "--soak",
         "--starts", "8", "--no-pictures", "--markdown", "--resume", "--threads", "2", "--out",
         "there"});
    EXPECT_EQ(options.cases, (std::vector<std::string>{"teleport", "needles"}));
    EXPECT_EQ(options.steppers, std::vector<std::string>{"fast"});
    EXPECT_EQ(options.frames_scale, 0.5);
    EXPECT_TRUE(options.soak && options.markdown && options.resume && !options.pictures);
    EXPECT_EQ(options.threads, 2);
    EXPECT_EQ(options.starts, 8);
    EXPECT_EQ(options.out, "there");
}

TEST(HardCaseOptions, MotionsTakeThePlaceOfTheCases) {
    const HardCaseOptions options =
        parse_hard_case_options({"--motions", "01_01,01_03", "--garment", "tshirt"});
    EXPECT_EQ(options.motions, (std::vector<std::string>{"01_01", "01_03"}));
    EXPECT_EQ(options.garment, "tshirt");
    EXPECT_TRUE(options.cases.empty());
    EXPECT_TRUE(options.limbs);
    EXPECT_FALSE(parse_hard_case_options({"--motions", "01_01", "--no-limbs"}).limbs);
}

TEST(HardCaseOptions, AWrongGarmentIsAnsweredWithTheRightOnes) {
    try {
        parse_hard_case_options({"--motions", "01_01", "--garment", "toga"});
        FAIL() << "there is no toga";
    } catch (const UsageError& error) {
        const std::string text = error.what();
        for (const char* part : {"toga", "pants_1000", "tshirt"})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

TEST(HardCaseOptions, FoldersOfMotionsAreListed) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / "hard_cases_motions";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    EXPECT_THROW(with_folders_listed({folder.string()}), LoadError);
    for (const char* name : {"b.bvh", "a.bvh", "c.txt"}) std::ofstream(folder / name) << "x";
    EXPECT_EQ(with_folders_listed({"01_01", folder.string()}),
              (std::vector<std::string>{"01_01", folder / "a.bvh", folder / "b.bvh"}));
    std::filesystem::remove_all(folder);
}

TEST(HardCaseOptions, AMotionThatIsNotThereIsRefusedByName) {
    try {
        motion_case("moonwalk", "tshirt_1000");
        FAIL();
    } catch (const LoadError& error) {
        EXPECT_NE(std::string(error.what()).find("moonwalk"), std::string::npos);
    }
}

TEST(HardCaseOptions, AnUnknownCaseIsRefusedWithTheCasesThereAre) {
    const std::string text = message([] { parse_hard_case_options({"--cases", "moon"}); });
    for (const HardCase& hard : hard_cases()) EXPECT_NE(text.find(hard.name), std::string::npos);
}

TEST(HardCaseOptions, AnUnknownStepperIsRefusedWithTheSteppersThereAre) {
    const std::string text = message([] { check_steppers({"quasi-newton-3", "moon"}, {}); });
    for (const char* name : {"moon", "reference", "quasi-newton-K", "xpbd-N", "fast"})
        EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_EQ(message([] { check_steppers(default_hard_case_steppers(), {}); }), "");
}

TEST(HardCaseOptions, WrongValuesAreRefused) {
    using Arguments = std::vector<std::string>;
    for (const Arguments& wrong :
         {Arguments{"--moon", "1"}, Arguments{"--cases"}, Arguments{"--frames-scale", "0"},
          Arguments{"--frames-scale", "1x"}, Arguments{"--frames-scale", "nan"},
          Arguments{"--threads", "-1"}, Arguments{"--steppers", ""}, Arguments{"--help"}})
        EXPECT_THROW(parse_hard_case_options(wrong), UsageError) << wrong[0];
}

TEST(HardCases, NamesAreKebabCaseAndUniqueAndBoundsHaveReasons) {
    std::set<std::string> names;
    for (const HardCase& hard : hard_cases()) {
        EXPECT_TRUE(names.insert(hard.name).second) << hard.name;
        EXPECT_EQ(hard.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-"),
                  std::string::npos);
        EXPECT_FALSE(hard.sentence.empty());
        EXPECT_STRNE(hard.bounds.reason, "") << hard.name;
        ASSERT_TRUE(hard.bounds.stretch_p99) << hard.name;
        EXPECT_LT(*hard.bounds.stretch_p99, 10.0) << hard.name;
        EXPECT_GT(hard.frames, 0) << hard.name;
        EXPECT_TRUE(hard.parts) << hard.name;
    }
}

TEST(HardCases, FramesScaleAndTheSoakCasesLast) {
    EXPECT_EQ(scaled_frames(hard_case("needles"), 1.0, 10000), hard_case("needles").frames);
    EXPECT_EQ(scaled_frames(hard_case("needles"), 1e-3), 1);
    EXPECT_EQ(scaled_frames(hard_case("soak-rest"), 1.0, 10000), 10000);
}

}  // namespace cloth::options_test
