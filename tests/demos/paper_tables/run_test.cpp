// From a scene to the page: a small garment for two frames.

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/compare/arguments.h"
#include "demos/paper_tables/paper_run.h"
#include "render/replaced_file.h"

namespace cloth::paper_run_test {

namespace {

using Json = nlohmann::ordered_json;

struct SmallRun {
    PaperOptions options;
    int measured = 0;        ///< solvers of which a rollout was told about
    int interrupted_at = 0;  ///< in the rollout of this one; 0: never

    explicit SmallRun(const std::string& name) {
        options.out = ::testing::TempDir() + name;
        std::filesystem::remove_all(options.out);
        options.garments = {"tshirt_1000"};
        options.solvers = {"hood+0", "fast+0", "xpbd-40"};
        options.frames = 2;
        options.weights = options.out + "/weights";
        options.references = options.out + "/parts";
        std::filesystem::create_directories(options.weights);
        const std::filesystem::path assets = CLOTH_SOURCE_DIR "/data/assets/weights";
        std::filesystem::copy_file(assets / "fast.safetensors",
                                   options.weights + "/fast.safetensors");
    }
    ~SmallRun() { std::filesystem::remove_all(options.out); }
    SmallRun(const SmallRun&) = delete;
    SmallRun& operator=(const SmallRun&) = delete;

    Json operator()() {
        measured = 0;
        run_paper_tables(options, 1, [&](int done, int, const std::string& what) {
            if (done != 1 || what.find("rollout") == std::string::npos) return;
            if (++measured == interrupted_at) throw std::runtime_error("interrupted");
        });
        return Json::parse(read_file(options.out + "/paper_tables.json"));
    }
};

const Json& row_of(const Json& report, const std::string& solver) {
    for (const Json& row : report.at("rows"))
        if (row.at("solver") == solver) return row;
    throw std::runtime_error("no row of " + solver);
}

}  // namespace

TEST(PaperRun, MeasuresOnceAndSaysWhatIsMissing) {
    SmallRun run("paper_run");
    const Json report = run();
    EXPECT_EQ(run.measured, 2);
    ASSERT_EQ(report.at("rows").size(), 3u);
    const Json &fast = row_of(report, "fast+0"), &xpbd = row_of(report, "xpbd-40");
    EXPECT_EQ(row_of(report, "hood+0").at("missing"), "not trained yet: no hood.safetensors");
    for (const Json& row : {fast, xpbd}) {
        EXPECT_EQ(row.at("frames"), 2);
        EXPECT_NEAR(row.at("fps").get<double>() * row.at("ms_median").get<double>(), 1e3, 0.1);
        EXPECT_GT(row.at("gap_median"), 0.0);
        EXPECT_GT(row.at("fine_rmse_mm"), 0.0);
        EXPECT_LT(row.at("fine_rmse_mm"), 20.0) << "after two frames";
        const Json& loss = row.at("loss");
        double sum = 0.0;
        for (const char* term : {"strain", "bending", "contact", "gravity", "inertia", "friction"})
            sum += loss.at(term).get<double>();
        EXPECT_NEAR(sum, loss.at("total").get<double>(), 1e-4 * std::abs(sum));
        EXPECT_GT(loss.at("strain"), 0.0);
        EXPECT_TRUE(row.at("failure").is_null());
    }
    EXPECT_GT(fast.at("network_mb"), 1.0);
    EXPECT_GT(fast.at("network_ms"), 0.0);
    EXPECT_TRUE(xpbd.at("network_mb").is_null());
    EXPECT_TRUE(xpbd.at("network_ms").is_null());
    const std::string page = read_file(run.options.out + "/paper_tables.md");
    EXPECT_NE(page.find("## Table 2: tshirt_1000"), std::string::npos);

    EXPECT_EQ(run().at("rows"), report.at("rows"));
    EXPECT_EQ(run.measured, 0) << "the rows are kept";
    run.options.again = true;
    run.options.solvers = {"xpbd-40"};
    const Json again = run();
    EXPECT_EQ(again.at("rows").size(), 1u);
    EXPECT_EQ(again.at("rows")[0].at("loss"), xpbd.at("loss")) << "deterministic";
}

TEST(PaperRun, GoesOnWhereItWasInterrupted) {
    SmallRun run("paper_run_interrupted");
    run.interrupted_at = 2;
    EXPECT_THROW(run(), std::runtime_error);
    run.interrupted_at = 0;
    const Json report = run();
    EXPECT_EQ(run.measured, 1) << "fast+0 was done";
    EXPECT_FALSE(row_of(report, "fast+0").at("loss").is_null());
    EXPECT_FALSE(row_of(report, "xpbd-40").at("loss").is_null());
}

TEST(PaperRun, WhatCannotBeUsedIsKnownBeforeAnythingIsMeasured) {
    SmallRun run("paper_run_wrong");
    run.options.solvers = {"xpbd-40", "hoood+0"};
    EXPECT_THROW(run(), UsageError);
    run.options.solvers = {"xpbd-40", "quasi-newton-x"};
    EXPECT_THROW(run(), UsageError);
    run.options.neighbours = run.options.out + "/neighbours.json";
    for (const char* text : {"{", "{\"series\": \"states\", \"rows\": []}",
                             "{\"series\": \"neighbours\", \"rows\": [{\"name\": \"many\"}]}"}) {
        write_text_file(run.options.neighbours, text);
        try {
            run();
            FAIL() << text;
        } catch (const LoadError& error) {
            EXPECT_NE(std::string(error.what()).find("train_series --series neighbours"),
                      std::string::npos);
        }
    }
    EXPECT_EQ(run.measured, 0);
}

}  // namespace cloth::paper_run_test
