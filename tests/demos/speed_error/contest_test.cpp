// A small sheet, three frames: the whole way from a scene to its rows.

#include "demos/speed_error/contest.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"
#include "demos/compare/arguments.h"
#include "demos/speed_error/reference_cache.h"
#include "demos/speed_error/scene_report.h"

namespace cloth::contest_test {

namespace {

const auto quiet = [](int, int, const std::string&) {};

SceneSettings tiny(const std::string& scene) {
    return {scene, "soft", /*frames=*/3, /*vertices=*/100};
}

ContestSettings contest_of(const std::vector<std::string>& solvers, const std::string& folder) {
    ContestSettings settings;
    settings.solvers = solvers;
    settings.relative_to = "quasi-newton-3";
    settings.work = ::testing::TempDir() + folder;
    std::filesystem::remove_all(settings.work);
    return settings;
}

/// Keeps still, and fails from its n-th step on: by its report, or by numbers that are not finite.
class FailingStepper : public Stepper {
 public:
    FailingStepper(int steps, bool reports) : m_steps(steps), m_reports(reports) {}
    std::string name() const override { return "failing"; }
    StepReport step(const Boundary&, double, ClothState& state) override {
        StepReport report;
        const bool fails = m_done++ >= m_steps;
        report.finite = !(fails && m_reports);
        if (fails && !m_reports) state.x(0, 0) = std::nan("");
        return report;
    }

 private:
    int m_steps;
    bool m_reports;
    int m_done = 0;
};

/// A row without what differs from run to run.
nlohmann::ordered_json repeatable(const SolverRow& row) {
    nlohmann::ordered_json json = to_json(row);
    for (const char* name : {"ms_median", "ms_p95", "ms_longest", "ms_ratio", "peak_memory_mb"})
        json.erase(name);
    return json;
}

}  // namespace

TEST(Contest, ASheetGivesRowsOfSenseTwice) {
    const std::vector<std::string> solvers = {"bullet-10x2",    "xpbd-20",   "quasi-newton-1",
                                              "quasi-newton-3", "reference", "fast+1"};
    const ContestSettings settings = contest_of(solvers, "speed_error_rows");
    const SceneReport report = measure_scene(tiny("sheet"), settings, quiet);
    ASSERT_EQ(report.rows.size(), solvers.size());
    for (size_t k = 0; k < solvers.size(); ++k) {
        const SolverRow& row = report.rows[k];
        EXPECT_EQ(row.solver, solvers[k]);
        EXPECT_EQ(row.frames, 3);
        EXPECT_TRUE(row.finite);
        EXPECT_GT(row.ms_median, 0.0);
        EXPECT_GE(row.ms_p95, row.ms_median);
        EXPECT_GE(row.ms_longest, row.ms_p95);
        EXPECT_GT(row.ms_ratio, 0.0);
        EXPECT_GE(row.fine_rmse_mm, 0.0);
        EXPECT_TRUE(std::isnan(row.penetration_max_mm)) << "nothing to be inside of";
    }
    EXPECT_EQ(report.rows[3].ms_ratio, 1.0);
    EXPECT_LT(report.rows[3].gap_median, report.rows[2].gap_median);
    EXPECT_EQ(report.rows[4].gap_median, 0.0);
    EXPECT_EQ(report.rows[4].rollout_rmse_mm, 0.0);
    EXPECT_EQ(report.rows[5].network->backend, "engine");
    EXPECT_EQ(report.rows[5].network->refine, 1);

    // again, with the references from the files
    const SceneReport again = measure_scene(tiny("sheet"), settings, quiet);
    for (size_t k = 0; k < solvers.size(); ++k)
        EXPECT_EQ(repeatable(again.rows[k]), repeatable(report.rows[k]));
}

TEST(Contest, ASphereIsAnObstacle) {
    const SceneReport report = measure_scene(
        tiny("sphere"), contest_of({"quasi-newton-3@1000"}, "speed_error_sphere"), quiet);
    EXPECT_EQ(report.description.at("obstacles"), 1);
    EXPECT_GE(report.rows[0].penetration_max_mm, 0.0);
    EXPECT_GT(report.rows[0].peak_memory_mb, 0.0);
}

TEST(Contest, OthersGoOnWhenASolverFails) {
    const auto scene = make_scene(tiny("sheet"));
    const ClothState start = ClothState::at_rest(scene->garment());
    const References references{coarse_reference(*scene, {start}, 3, quiet), {}};
    for (bool reports : {true, false}) {
        std::vector<Contestant> contestants;
        contestants.push_back({"failing", {std::make_unique<FailingStepper>(1, reports), 0.0}});
        contestants.push_back({"still", {std::make_unique<FailingStepper>(100, reports), 0.0}});
        const auto results = run_contest(*scene, start, references, contestants, quiet);
        const SolverRow failed = make_row("failing", results[0], results[1].rollout.ms);
        EXPECT_FALSE(failed.finite);
        EXPECT_EQ(failed.first_failed_frame, 1);
        EXPECT_EQ(failed.failure, "not finite");
        EXPECT_TRUE(to_json(failed).at("gap_median").is_null()) << "no step to score";
        const SolverRow still = make_row("still", results[1], {});
        EXPECT_TRUE(still.finite);
        EXPECT_EQ(still.frames, 3);
        EXPECT_NEAR(still.progress_median, 1.0, 1e-9);
        EXPECT_FALSE(still.first_failed_frame);
    }
}

TEST(ReferenceCache, GoesOnWhereAShorterRunStopped) {
    const std::string work = contest_of({}, "speed_error_cache").work;
    const auto references_of = [&](int frames, const std::string& name) {
        SceneSettings settings = tiny("sphere");
        settings.frames = frames;
        const auto scene = make_scene(settings);
        const ReferenceCache cache(work, name, *scene);
        return cache.references(cache.start(quiet), quiet);
    };
    const References whole = references_of(8, "whole");
    references_of(3, "parts");
    const References parts = references_of(8, "parts");
    ASSERT_EQ(parts.fine.size(), 9u);
    for (size_t k = 0; k < 9; ++k) {
        EXPECT_EQ(parts.coarse[k].x, whole.coarse[k].x);
        EXPECT_EQ(parts.fine[k].x, whole.fine[k].x);
    }
    EXPECT_EQ(references_of(2, "parts").coarse.size(), 3u);
}

TEST(Contest, ReferencesOfAFileThatChangedAreMadeAnew) {
    const ContestSettings contest = contest_of({"xpbd-5"}, "speed_error_changed");
    const std::string shirt = ::testing::TempDir() + "speed_error_shirt.obj";
    const TriMesh mesh = load_garment_mesh("tshirt_1000");
    SceneSettings settings = tiny(shirt);
    settings.frames = 1;
    const auto kept_files = [&] {
        const std::filesystem::directory_iterator files(contest.work);
        return std::distance(begin(files), end(files));
    };
    for (const double size : {1.0, 1.001, 1.001}) {
        save_obj(shirt, {size * mesh.vertices, mesh.faces});
        measure_scene(settings, contest, quiet);
        EXPECT_EQ(kept_files(), size == 1.0 ? 3 : 6) << "start and two references of each";
    }
}

TEST(Contest, UnknownNamesAreRefusedBeforeTheDearPart) {
    const auto refused = [](const std::string& solver) {
        const ContestSettings settings = contest_of({solver}, "speed_error_unknown");
        EXPECT_THROW(measure_scene(tiny("sheet"), settings, quiet), UsageError) << solver;
        for (const auto& file : std::filesystem::directory_iterator(settings.work))
            EXPECT_EQ(file.path().string().find("reference"), std::string::npos);
    };
    for (const char* solver : {"bulet", "bullet-1x2", "bullet-2x0", "bullet-2x", "quasi-newton-",
                               "newton-", "xpbd-0", "fast+101", "torch-fast+0"})
        refused(solver);
    EXPECT_THROW(make_scene({"moon", "soft", 3, 100}), UsageError);
    EXPECT_THROW(make_scene({"sheet", "silk", 3, 100}), UsageError);
}

}  // namespace cloth::contest_test
