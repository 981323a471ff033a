#include "demos/compare/solver_factory.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "data/authoring/sheet.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"
#include "tests/gnn/model/random_weights.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::solver_factory_test {

namespace {

class FreeSheet : public ComparisonScene {
 public:
    explicit FreeSheet(int rate = 30)
        : ComparisonScene(Garment("sheet", cloth::test::sheet(4, 0.1), Fabric::soft_cotton()),
                          rate) {}

    Boundary boundary(double, double) const override {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        return boundary;
    }
};

/// 900 vertices, without an outside.
class LargeSheet : public ComparisonScene {
 public:
    LargeSheet()
        : ComparisonScene(
              Garment("large sheet", make_sheet(0.5, 0.5, 900), Fabric::soft_cotton())) {}
    Boundary boundary(double, double) const override { return FreeSheet().boundary(0.0, 0.0); }
};

std::string refusal(const std::string& name, int rate = 30) {
    try {
        make_solver(name, FreeSheet(rate), {});
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(SolverFactory, PhysicalSolversAreWhatTheirNamesSay) {
    const FreeSheet scene;
    for (const std::string name :
         {"bullet", "bullet-fine", "bullet-50", "quasi-newton-1", "quasi-newton-10", "quasi-newton",
          "quasi-newton-3x4", "quasi-newton-3s120", "quasi-newton-3s120-bdf2",
          "quasi-newton-1s120-cg10", "quasi-newton-2s60-cg5-bdf2", "xpbd-1", "xpbd-20", "xpbd-100"})
        EXPECT_EQ(make_solver(name, scene, {})->name(), name);
}

TEST(SolverFactory, NetworksAreCalledWhatTheUserChose) {
    const FreeSheet scene;
    for (const std::string name : {"small", "small+3", "fast", "fast+0"})
        EXPECT_EQ(make_solver(name, scene, {})->name(), name);
    EXPECT_EQ(make_solver("bf16-small", scene, {})->name(), "small");
}

TEST(SolverFactory, AFolderOfNetworksThatIsNotThereIsNamed) {
    for (const std::string name : {"small", "quasi-newton-3"}) try {
            make_solver(name, FreeSheet(), {"/no/such", 1, nullptr});
            ADD_FAILURE() << name;
        } catch (const UsageError& error) {
            EXPECT_STREQ(error.what(),
                         "--weights /no/such: there is no such folder; give one with "
                         "NAME.safetensors");
        }
}

TEST(SolverFactory, NetworksKeepToTheirTimeStep) {
    for (const std::string name : {"small", "small+3", "small+3@20"}) {
        const std::string text = refusal(name, 60);
        for (const char* word : {"small", "1/30 s", "--rate"})
            EXPECT_NE(text.find(word), std::string::npos) << text;
    }
    EXPECT_EQ(refusal("quasi-newton", 60), "");
    EXPECT_EQ(refusal("xpbd-20", 60), "");
}

/// A folder with a network `short` for 1/60 s.
class ShortSteps : public ::testing::Test {
 protected:
    ShortSteps() {
        ModelConfig config = ModelConfig::variant_named("fast", 2);
        config.width = 16;
        config.dt = 1.0 / 60.0;
        m_settings.weights = ::testing::TempDir() + "/short_steps";
        std::filesystem::create_directories(m_settings.weights);
        test::random_weights(config).save(m_settings.weights + "/short.safetensors");
    }

    std::string made(const std::string& name, int rate) const {
        const FreeSheet scene(rate);
        const auto stepper = make_solver(name, scene, m_settings);
        EXPECT_NEAR(stepper->fixed_dt(), scene.frame_time(), 1e-12);
        return stepper->name();
    }

    SolverSettings m_settings;
};

TEST_F(ShortSteps, AFileWithAMarkInItsNameIsRefusedAndNotListed) {
    const std::string file = m_settings.weights + "/short~1.safetensors";
    std::filesystem::copy_file(m_settings.weights + "/short.safetensors", file,
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(networks_in(m_settings.weights), std::vector<std::string>{"short"});
    try {
        make_solver("short~1", FreeSheet(60), m_settings);
        ADD_FAILURE() << "it was taken for a proxy";
    } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "solver short~1: ~, + and @ have a meaning in solvers' names; rename " + file);
    }
    std::filesystem::remove(file);
}

TEST_F(ShortSteps, AreTakenOneAfterTheOtherInEachFrame) {
    EXPECT_EQ(made("short+1", 60), "short+1");
    EXPECT_EQ(made("short+1", 30), "short+1x2");
    EXPECT_EQ(made("short", 10), "shortx6");
    for (const int rate : {90, 40})
        EXPECT_THROW(make_solver("short+1", FreeSheet(rate), m_settings), UsageError) << rate;
}

TEST_F(ShortSteps, AreTheSmallStepsOfAFrame) {
    for (const auto& [name, rate] : {std::pair("short+1s60", 30), std::pair("short+0s60", 10)})
        EXPECT_EQ(make_solver(name, FreeSheet(rate), m_settings)->name(), name);
    EXPECT_THROW(make_solver("short+1s60", FreeSheet(25), m_settings), UsageError);
    const LargeSheet scene;
    EXPECT_EQ(make_solver("short+1s60~120", scene, m_settings)->name().rfind("short+1s60~1", 0),
              0u);
}

TEST_F(ShortSteps, AreThoseOfAProxyAlone) {
    const LargeSheet scene;
    const auto stepper = make_solver("short+2~120", scene, m_settings);
    EXPECT_EQ(stepper->name().rfind("short+2x2~1", 0), 0u) << stepper->name();
    ClothState state = ClothState::at_rest(scene.garment());
    const double frame = scene.frame_time();
    ASSERT_TRUE(stepper->step(scene.boundary(0.0, 0.0), frame, state).finite);
    // The guess, free fall, is the minimum, which no network can better.
    const double fall = state.x.col(1).mean() - scene.garment().rest().vertices.col(1).mean();
    EXPECT_NEAR(fall, -0.75 * 9.81 * frame * frame, 1e-6) << "two steps of backward Euler";
}

TEST(SolverFactory, NetworkNamesSayWhatRunsThem) {
    const NetworkName plain("fast_16"), torch("torch-fast+0"), rounded("bf16-fast+12");
    EXPECT_TRUE(plain.as_shipped && !plain.torch && !plain.bfloat16);
    EXPECT_TRUE(torch.torch && !torch.as_shipped && rounded.bfloat16);
    EXPECT_EQ(plain.variant, "fast_16");
    EXPECT_EQ(torch.variant, "fast");
    EXPECT_EQ(rounded.refine, "12");
    EXPECT_NO_THROW(make_solver("bf16-fast+0", FreeSheet(), {}));
}

TEST(SolverFactory, ProxiesAreSimulatedByAnySolver) {
    const LargeSheet scene;
    for (const std::string name :
         {"bullet", "quasi-newton", "quasi-newton-5-bdf2", "xpbd-20", "small+3", "reference"}) {
        SCOPED_TRACE(name);
        const auto stepper = make_solver(name + "~120", scene, {});
        EXPECT_EQ(stepper->name().rfind(make_solver(name, scene, {})->name() + "~1", 0), 0u)
            << stepper->name();
        ClothState state = ClothState::at_rest(scene.garment());
        ASSERT_TRUE(stepper->step(scene.boundary(0.0, 0.0), scene.frame_time(), state).finite);
        EXPECT_LT(state.x.col(1).maxCoeff(), -5e-3) << "it does not fall";
    }
    EXPECT_NO_THROW(make_solver("quasi-newton~120@20", scene, {}));
}

TEST(SolverFactory, ProxiesAreShownWithDetail) {
    const LargeSheet scene;
    for (const auto& [name, detail] :
         {std::pair("xpbd-20~120+2", "+quasi-newton-2"), std::pair("default~120+small", "+small+0"),
          std::pair("default~120+bf16-small+1", "small+1"),
          std::pair("xpbd-20~120+0", "xpbd-20~1")}) {
        SCOPED_TRACE(name);
        const auto stepper = make_solver(name, scene, {});
        EXPECT_NE(stepper->name().find(detail), std::string::npos) << stepper->name();
        ClothState state = ClothState::at_rest(scene.garment());
        ASSERT_TRUE(stepper->step(scene.boundary(0.0, 0.0), scene.frame_time(), state).finite);
        EXPECT_LT(state.x.col(1).maxCoeff(), -5e-3) << "it does not fall";
    }
}

TEST(SolverFactory, ProxiesAreRefusedByName) {
    const LargeSheet scene;
    const auto refused = [&](const std::string& name) -> std::string {
        try {
            make_solver(name, scene, {});
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    };
    for (const auto& [name, word] :
         {std::pair("quasi-newton~", "~"), std::pair("quasi-newton~19", "from 20"),
          std::pair("quasi-newton~1000", "large sheet: it has 900 vertices"),
          std::pair("quasi-newton~no_such_shirt", "tshirt_1000"),
          std::pair("quasi-newton~tshirt_1000", "from the coarse mesh"),
          std::pair("nothing~120", "xpbd-N"), std::pair("xpbd-20~120@10", "no limit"),
          std::pair("xpbd-20~120+nothing", "xpbd-N"), std::pair("xpbd-20~120+2000", "to 1000"),
          std::pair("xpbd-20~120+small+x", "whole number")})
        EXPECT_NE(refused(name).find(word), std::string::npos) << name << ": " << refused(name);
}

TEST(SolverFactory, SkinningNetworksAreOfTheirGarmentAlone) {
    BodySceneSettings settings;
    settings.garment = "tshirt_1000";
    settings.frames = 1;
    for (const bool limbs : {false, true}) {
        settings.limbs = limbs;
        const BodyScene scene(settings);
        for (const std::string name : {"skinning", "skinning-raw"}) {
            const auto stepper = make_solver(name, scene, {});
            EXPECT_EQ(stepper->name(), name);
            EXPECT_NEAR(stepper->fixed_dt(), 1.0 / 30.0, 1e-12);
            ClothState state = scene.start();
            EXPECT_TRUE(stepper->step(scene.frame_boundary(0), 1.0 / 30.0, state).finite);
        }
    }
    for (const char* word : {"solver skinning", "garment sheet", "train_skinning"})
        EXPECT_NE(refusal("skinning").find(word), std::string::npos) << refusal("skinning");
    EXPECT_NE(refusal("skinning+3").find("skinning-raw"), std::string::npos);
}

TEST(SolverFactory, RefusesUnknownNamesAndNumbersByName) {
    for (const std::string name :
         {"xpbd", "xpbd-", "xpbd-0", "xpbd-1001", "xpbd-20x", "xpbd--1", "quasi-newtons",
          "quasi-newton-", "quasi-newton-3s0", "quasi-newton-3s10000", "bullet-fast"})
        EXPECT_NE(refusal(name).find("solver " + name), std::string::npos) << refusal(name);
    EXPECT_NE(refusal("nothing").find("xpbd-N"), std::string::npos) << refusal("nothing");
}

}  // namespace cloth::solver_factory_test
