// The way from a run to rows in a file.

#include "demos/hard_cases/report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"
#include "demos/hard_cases/case_scenes.h"
#include "demos/hard_cases/contest.h"
#include "demos/hard_cases/motion_cases.h"

namespace cloth::report_test {

namespace {

const auto quiet = [](int, int, const std::string&) {};

/// A small free sheet that falls, in a case with the given bounds.
HardCase falling(const Bounds& bounds) {
    return {"falling", "a sheet falls", 4, bounds, [] {
                Garment garment("sheet", level_sheet(60), Fabric::soft_cotton());
                const ClothState start = ClothState::at_rest(garment);
                const auto outside = [](double, double) {
                    Boundary boundary;
                    boundary.pin_targets.resize(0, 3);
                    return boundary;
                };
                return HardSceneParts{std::move(garment), start, outside};
            }};
}

/// Does what it is told to the state, from the n-th step on.
class SpoilingStepper : public Stepper {
 public:
    using Spoil = std::function<bool(ClothState&)>;
    SpoilingStepper(int steps, Spoil spoil, double fixed = 0.0)
        : m_steps(steps), m_spoil(std::move(spoil)), m_fixed(fixed) {}
    std::string name() const override { return "spoiling"; }
    double fixed_dt() const override { return m_fixed; }
    StepReport step(const Boundary&, double dt, ClothState& state) override {
        StepReport report;
        state.time += dt;
        if (m_done++ >= m_steps) report.finite = m_spoil(state);
        return report;
    }

 private:
    int m_steps;
    Spoil m_spoil;
    double m_fixed;
    int m_done = 0;
};

HardRun run(const HardCase& hard, SpoilingStepper stepper, HardSceneParts parts) {
    const HardScene scene(std::move(parts), hard.frames);
    return run_hard_case(hard, scene, stepper, picture_frames(scene.frames()), [](int) {});
}
HardRun run(const HardCase& hard, SpoilingStepper stepper) {
    return run(hard, std::move(stepper), hard.parts());
}

/// The vertex nearest to the origin.
Vec3 middle_of(const Points& x) {
    Eigen::Index middle = 0;
    x.rowwise().norm().minCoeff(&middle);
    return x.row(middle);
}

Bounds strict() {
    Bounds bounds;
    bounds.stretch_p99 = 1.5;
    bounds.rest_jitter_mm = 0.05;
    return bounds;
}

}  // namespace

TEST(HardRun, KeepingStillIsHeld) {
    const HardRun still = run(falling(strict()), {100, [](ClothState&) { return true; }});
    EXPECT_TRUE(still.held()) << still.failure;
    EXPECT_EQ(still.frames, 4);
    EXPECT_EQ(still.x.size(), 3u);
    EXPECT_EQ(still.rest_jitter_mm, 0.0);
}

TEST(HardRun, SaysWhatFailedFirstAndWhen) {
    const auto spoilt = [](SpoilingStepper::Spoil spoil) {
        return run(falling(strict()), {2, std::move(spoil)});
    };
    const HardRun torn = spoilt([](ClothState& s) { return s.x *= 2.0, true; });
    EXPECT_EQ(torn.first_failed_frame, 2);
    EXPECT_NE(torn.failure.find("stretched to 2.00"), std::string::npos) << torn.failure;
    EXPECT_EQ(torn.frames, 4) << "it goes on";
    const HardRun refused = spoilt([](ClothState&) { return false; });
    EXPECT_EQ(refused.failure, "not finite");
    EXPECT_EQ(refused.frames, 3);
    const HardRun lost = spoilt([](ClothState& s) { return s.x(0, 0) = std::nan(""), true; });
    EXPECT_FALSE(lost.finite);
    const HardRun restless = spoilt([](ClothState& s) { return s.x.array() += 1e-4, true; });
    EXPECT_NE(restless.failure.find("per frame at rest"), std::string::npos) << restless.failure;
    EXPECT_EQ(restless.first_failed_frame, 3);
    Bounds lively;
    lively.least_top_speed = 1.0;
    const HardRun slow = run(falling(lively), {100, [](ClothState&) { return true; }});
    EXPECT_NE(slow.failure.find("slow motion"), std::string::npos) << slow.failure;
}

TEST(HardRun, WhatIsLostForAThirdOfASecondOrAtTheEndIsLost) {
    HardCase hard = falling({});
    hard.frames = 30;
    const auto lost_in = [&](int first, int last) {
        HardSceneParts parts = hard.parts();
        parts.loss = [=, frame = 0](const Boundary&, const Points&) mutable {
            ++frame;
            return frame > first && frame <= last + 1 ? "gone" : "";
        };
        return run(hard, {100, [](ClothState&) { return true; }}, std::move(parts));
    };
    EXPECT_TRUE(lost_in(5, 13).held()) << "nine frames";
    const HardRun lost = lost_in(5, 14);
    EXPECT_EQ(lost.first_failed_frame, 5);
    EXPECT_EQ(lost.failure, "gone");
    EXPECT_EQ(lost_in(27, 29).first_failed_frame, 27);
    EXPECT_TRUE(lost_in(27, 28).held());
}

TEST(HardScene, StartsDifferALittleAndOnlyWhereClothIsFree) {
    const HardScene scene(swing(level_sheet(60), {}), 1);
    const Points x = scene.start().x;
    EXPECT_EQ(scene.start_from(0).x, x);
    for (const int which : {1, 2, 1000}) {
        const ClothState start = scene.start_from(which);
        const Points off = start.x - x;
        EXPECT_EQ(start.x, scene.start_from(which).x);
        EXPECT_NE(start.x, scene.start_from(which + 1).x);
        EXPECT_LE(off.cwiseAbs().maxCoeff(), 1.001e-7);
        EXPECT_GT(off.cwiseAbs().maxCoeff(), 0.9e-7);
        EXPECT_LT(off.colwise().mean().cwiseAbs().maxCoeff(), 0.5e-7) << "to all sides";
        for (const int pin : scene.garment().pins()) EXPECT_EQ(off.row(pin).norm(), 0.0);
    }
}

TEST(HardRun, BeginsAtTheStartThatItIsTold) {
    const HardCase hard = falling({});
    HardSceneParts parts = hard.parts();
    const double at_first = parts.start.x(0, 0);
    parts.loss = [=](const Boundary&, const Points& x) { return x(0, 0) > at_first ? "off" : ""; };
    const HardScene scene(std::move(parts), hard.frames);
    int held = 0;
    for (int start = 0; start < 20; ++start) {
        SpoilingStepper still(100, [](ClothState&) { return true; });
        const HardRun run = run_hard_case(
            hard, scene, still, {}, [](int) {}, start);
        EXPECT_EQ(run.held(), scene.start_from(start).x(0, 0) <= at_first);
        held += run.held() ? 1 : 0;
    }
    EXPECT_GT(held, 1);
    EXPECT_LT(held, 20);
}

TEST(HardContest, CountsTheStartsFromWhichACaseIsHeld) {
    const auto result = [](const HardCase& hard) {
        HardContest contest{&hard, 4, {}, {}};
        contest.starts = 3;
        return run_stepper(contest, HardScene(hard.parts(), 4), "xpbd-5", quiet).row;
    };
    const HardRow held = result(falling({}));
    EXPECT_EQ(held.starts, 3);
    EXPECT_EQ(held.starts_held, 3);
    EXPECT_NE(text_line(held).find("held from 3 of 3 starts"), std::string::npos);
    Bounds impossible;
    impossible.rms_speed = 0.0;
    const HardRow failed = result(falling(impossible));
    EXPECT_EQ(failed.starts_held, 0);
    EXPECT_NE(markdown({failed}).find("(held from 0 of 3 starts) |"), std::string::npos)
        << markdown({failed});
}

TEST(HardRun, InsideAnObstacleIsSeenButNotOfPins) {
    HardSceneParts parts = swing(level_sheet(60), {});
    const Vec3 pin = parts.start.x.row(parts.garment.pins()[0]);
    const auto around = [&](const Vec3& centre) {
        HardSceneParts changed = parts;
        changed.outside = [=](double t0, double t1) {
            Boundary boundary = parts.outside(t0, t1);
            boundary.obstacles = {ball(0.01, centre, centre)};
            return boundary;
        };
        return run(falling({}), {100, [](ClothState&) { return true; }}, changed);
    };
    EXPECT_TRUE(around(pin).held()) << around(pin).failure;
    const HardRun inside = around(middle_of(parts.start.x));
    EXPECT_NEAR(inside.penetration_mm[0], 10.0, 1e-6);
    EXPECT_EQ(inside.first_failed_frame, 0);
}

TEST(HardRun, ALimbThroughAFaceIsSeen) {
    const TriMesh sheet = level_sheet(60);
    Boundary boundary;
    const auto limb_at = [&](const Vec3& p) {
        boundary.obstacles = {capsule(1e-4, 0.1, placed(p), placed(p))};
        return is_impaled(boundary, sheet.faces, sheet.vertices);
    };
    EXPECT_TRUE(limb_at(Vec3(0.01, 0.05, 0.02)));
    EXPECT_FALSE(limb_at(Vec3(0.01, 0.15, 0.02))) << "above";
    EXPECT_FALSE(limb_at(Vec3(0.5, 0.0, 0.0))) << "beside";
}

TEST(HardRun, AStepperOfAFixedStepTakesSeveralPerFrame) {
    const HardScene scene(hard_case("step-1-10").parts(), 2);
    const auto keep = [](ClothState&) { return true; };
    EXPECT_EQ(not_applicable(SpoilingStepper(0, keep, 1.0 / 30.0), scene), "");
    EXPECT_EQ(not_applicable(SpoilingStepper(0, keep), scene), "");
    EXPECT_NE(not_applicable(SpoilingStepper(0, keep, 0.07), scene), "");
}

TEST(HardReport, RowsComeBackFromTheFile) {
    const std::string path = ::testing::TempDir() + "hard_cases.json";
    std::filesystem::remove(path);
    const HardCase hard = falling({});
    const HardScene scene(hard.parts(), 4);
    HardContest contest{&hard, 4, {}, {}};
    HardReport report(path, /*threads=*/1, /*resume=*/false);
    for (const char* stepper : {"quasi-newton-3", "xpbd-5"})
        report.add(run_stepper(contest, scene, stepper, quiet).row);
    report.add(skipped_row(hard, "reference", "too expensive", 4));
    report.add(refused_row(hard, "fast", "too small", 4));

    const HardReport again(path, /*threads=*/1, /*resume=*/true);
    ASSERT_EQ(again.rows().size(), 4u);
    for (size_t k = 0; k < 4; ++k) EXPECT_EQ(to_json(again.rows()[k]), to_json(report.rows()[k]));
    EXPECT_NE(again.find("falling", "xpbd-5", 4), nullptr);
    EXPECT_EQ(again.find("falling", "xpbd-5", 5), nullptr) << "another number of frames";
    EXPECT_EQ(again.find("falling", "xpbd-5", 4, 2), nullptr) << "more starts";
    const std::string table = markdown(again.rows());
    EXPECT_NE(table.find("| falling | held | held | not run | frame 0: refused: too small |"),
              std::string::npos)
        << table;
}

TEST(HardReport, RowsOfOtherGarmentsAndFilesAreNotTaken) {
    const std::string path = ::testing::TempDir() + "hard_cases_inputs.json";
    std::filesystem::remove(path);
    HardRow row = skipped_row(falling({}), "reference", "too expensive", 4);
    row.inputs = "skirt.obj, 5 bytes, 1234";
    HardReport(path, /*threads=*/1, /*resume=*/false).add(row);
    const HardReport again(path, /*threads=*/1, /*resume=*/true);
    EXPECT_NE(again.find("falling", "reference", 4, 1, row.inputs), nullptr);
    EXPECT_EQ(again.find("falling", "reference", 4, 1, "skirt.obj, 5 bytes, 5678"), nullptr);
    EXPECT_EQ(again.find("falling", "reference", 4), nullptr);
}

TEST(HardReport, AMotionCaseTellsItsGarmentAndFiles) {
    const std::string shirt = ::testing::TempDir() + "motion_case_shirt.obj";
    const TriMesh mesh = load_garment_mesh("tshirt_1000");
    save_obj(shirt, mesh);
    const std::string before = motion_case("01_01", shirt).inputs;
    EXPECT_EQ(motion_case("01_01", shirt).inputs, before);
    EXPECT_NE(motion_case("01_01", "tshirt_1000").inputs, before);
    save_obj(shirt, {1.001 * mesh.vertices, mesh.faces});
    EXPECT_NE(motion_case("01_01", shirt).inputs, before);
    EXPECT_NE(motion_case("01_01", "pants_1000").inputs,
              motion_case("01_01", "tshirt_1000").inputs);
}

TEST(HardReport, TheSchemaIsWhatReadersRelyOn) {
    const HardCase hard = falling(strict());
    const HardRow row =
        make_row(hard, "spoiling", run(hard, {1, [](ClothState&) { return false; }}), 4);
    const nlohmann::ordered_json json = to_json(row);
    EXPECT_EQ(json.at("case"), "falling");
    EXPECT_EQ(json.at("stepper"), "spoiling");
    EXPECT_EQ(json.at("held"), false);
    EXPECT_EQ(json.at("finite"), false);
    EXPECT_EQ(json.at("first_failed_frame"), 1);
    EXPECT_EQ(json.at("failure"), "not finite");
    EXPECT_EQ(json.at("frames"), 2);
    for (const char* time : {"ms_median", "ms_p95", "ms_longest"})
        EXPECT_TRUE(json.at(time).is_number()) << time;
    EXPECT_EQ(json.at("penetration_max_mm"), 0.0);
    EXPECT_EQ(json.at("stretch_p99"), 1.0);
    const nlohmann::ordered_json skipped =
        to_json(skipped_row(hard, "reference", "too expensive", 4));
    EXPECT_TRUE(skipped.at("held").is_null());
    EXPECT_TRUE(skipped.at("stretch_p99").is_null());
    EXPECT_TRUE(skipped.at("first_failed_frame").is_null());
    EXPECT_EQ(skipped.at("failure"), "too expensive");
}

TEST(HardReport, ABrokenFileIsNotOverwrittenSilently) {
    const std::string path = ::testing::TempDir() + "broken_hard_cases.json";
    std::ofstream(path) << "{\"rows\": [{}]}";
    EXPECT_THROW(HardReport(path, /*threads=*/1, /*resume=*/true), LoadError);
}

TEST(HardReport, RowsOfAnotherProgramAreNotMixedIn) {
    const std::string path = ::testing::TempDir() + "foreign_hard_cases.json";
    std::ofstream(path) << R"({"provenance": {"commit": "another"}, "rows": []})";
    try {
        HardReport(path, /*threads=*/1, /*resume=*/true);
        FAIL() << "rows of two programs in one report";
    } catch (const LoadError& error) {
        EXPECT_NE(std::string(error.what()).find("commit another"), std::string::npos);
    }
}

}  // namespace cloth::report_test
