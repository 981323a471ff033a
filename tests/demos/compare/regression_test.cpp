// A short rollout of the T-shirt by every solver must keep the figures that were committed in
// tshirt_metrics.json. After a change that moves them on purpose, run
//     CLOTH_WRITE_METRICS=1 regression_test
// and commit the new figures with the change.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "demos/compare/measure.h"
#include "demos/compare/options.h"
#include "demos/compare/solver_factory.h"

namespace cloth::regression_test {

using nlohmann::json;

namespace {

const std::string metrics_file =
    std::string(CLOTH_SOURCE_DIR) + "/tests/demos/compare/tshirt_metrics.json";

const std::vector<std::string> solver_names = {
    "bullet", "bullet-fine", "quasi-newton-3", "small", "small+3", "baseline", "fast", "fast+0"};

CompareOptions short_rollout() {
    CompareOptions options;
    options.garment = "tshirt_1000";
    options.frames = 20;
    options.reference_frames = 3;
    options.threads = 1;
    return options;
}

/// The scene, the settled start and the reference, made once for all solvers.
struct Fixture {
    Fixture() : options(short_rollout()), scene(scene_settings(options)) {
        const auto quiet = [](int, int, const std::string&) {};
        start = settle(scene, quiet);
        references.coarse =
            measure_reference(
                scene, start, {},
                [&] { return make_solver("reference", scene, solver_settings(options)); }, quiet)
                .trajectory;
    }

    json figures(const std::string& solver) const {
        const auto quiet = [](int, int, const std::string&) {};
        const Measurement m = measure(
            solver, scene, start, references,
            [&] { return make_solver(solver, scene, solver_settings(options)); }, quiet);
        const json& rollout = m.json["rollout"];
        return {{"finite", m.json["finite"]},
                {"gap", m.json["one_step"]["gap"]["median"]},
                {"penetration_mm", rollout["penetration"]["max_mm"]},
                {"stretch_p50", rollout["stretch"]["p50"]},
                {"stretch_p99", rollout["stretch"]["p99"]},
                {"height", m.trajectory.back().x.col(1).mean()}};
    }

    CompareOptions options;
    BodyScene scene;
    ClothState start;
    References references;
};

const Fixture& fixture() {
    static const Fixture shared;
    return shared;
}

}  // namespace

class TshirtRegression : public ::testing::TestWithParam<std::string> {};

TEST_P(TshirtRegression, KeepsItsFigures) {
    std::ifstream file(metrics_file);
    const json known = file ? json::parse(file) : json::object();
    const json actual = fixture().figures(GetParam());
    if (std::getenv("CLOTH_WRITE_METRICS")) {
        json updated = known;
        updated[GetParam()] = actual;
        std::ofstream(metrics_file) << updated.dump(1) << "\n";
        GTEST_SKIP() << "figures written to " << metrics_file;
    }
    ASSERT_TRUE(known.contains(GetParam())) << "no committed figures; see the top of this file";
    const json& expected = known[GetParam()];
    EXPECT_EQ(actual["finite"], expected["finite"]);
    // other processors round differently, and cloth amplifies it
    const auto near = [&](const char* field, double relative, double absolute) {
        const double value = expected[field].get<double>();
        EXPECT_NEAR(actual[field].get<double>(), value, absolute + relative * std::abs(value))
            << field;
    };
    near("gap", 0.1, 0.02);
    near("penetration_mm", 0.25, 1.0);
    near("stretch_p50", 0.005, 0.0);
    const bool torn = expected["stretch_p99"].get<double>() > 1.3;  // how far depends on rounding
    near("stretch_p99", torn ? 0.2 : 0.03, 0.0);
    near("height", 0.0, 0.005);
}

INSTANTIATE_TEST_SUITE_P(Solvers, TshirtRegression, ::testing::ValuesIn(solver_names),
                         [](const auto& solver) {
                             std::string name = solver.param;
                             for (char& c : name)
                                 if (c == '-' || c == '+') c = '_';
                             return name;
                         });

}  // namespace cloth::regression_test
