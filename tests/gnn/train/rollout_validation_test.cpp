#include "gnn/train/rollout_validation.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "gnn/train/network.h"
#include "gnn/train/reference_fingerprint.h"
#include "gnn/train/sheet_world.h"
#include "gnn/train/validation.h"

namespace cloth::rollout_validation_test {
namespace {

ModelConfig tiny_model() {
    ModelConfig config = ModelConfig::variant_named("fast");
    config.width = 16;
    config.steps = 2;
    return config;
}

SceneSettings sheets_only() {
    SceneSettings scenes;
    scenes.garment_share = 0.0;
    scenes.sheet_sizes = {60};
    return scenes;
}

/// Random weights; `boost` scales what the decoder gives.
Weights random_weights(float boost) {
    Network network(tiny_model(), torch::kCPU, 1);
    Weights weights = network.export_weights();
    for (float& value : weights.tensors.at("decoder.output.weight").data) value *= boost;
    for (float& value : weights.tensors.at("decoder.output.bias").data) value *= boost;
    return weights;
}

class Rollouts : public testing::Test {
 protected:
    Rollouts() {
        m_settings.sheet_vertices = 60;
        m_settings.frames = 8;
        m_settings.iterations = {0, 30};
        std::filesystem::remove_all(m_folder);
    }
    std::vector<RolloutResult> measure(const Weights& weights) const {
        return *RolloutValidation(m_factory, m_settings, m_folder).measure(weights, m_go);
    }

    std::string refusal(const SceneFactory& factory, const std::vector<std::string>& garments,
                        const std::vector<std::string>& clips) {
        m_settings.garments = garments;
        m_settings.clips = clips;
        try {
            RolloutValidation(factory, m_settings, m_folder);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }

    const SceneFactory m_factory{tiny_model(), sheets_only(), 1};
    const std::string m_folder = testing::TempDir() + "rollout_validation_" +
                                 testing::UnitTest::GetInstance()->current_test_info()->name();
    const std::atomic<bool> m_go{false}, m_stop{true};
    RolloutSettings m_settings;
};

TEST_F(Rollouts, IterationsAfterTheNetworkComeNearToTheReference) {
    const std::vector<RolloutResult> results = measure(random_weights(1.0f));
    ASSERT_EQ(results.size(), 4u);
    EXPECT_EQ(results[0].scene, "sheet-hanging");
    EXPECT_EQ(results[2].scene, "sheet-sphere");
    for (const size_t scene : {0u, 2u}) {
        const RolloutResult &alone = results[scene], &refined = results[scene + 1];
        EXPECT_EQ(alone.iterations, 0);
        EXPECT_EQ(refined.iterations, 30);
        EXPECT_TRUE(refined.is_sheet());
        EXPECT_EQ(refined.held, 8);
        EXPECT_EQ(refined.failure, "");
        EXPECT_LT(refined.distance, 0.25 * alone.distance);
        EXPECT_GT(refined.stretch, 0.99);
        EXPECT_LT(refined.penetration, 5e-3);
    }
    EXPECT_LT(results[1].distance, 1e-3) << "without contact 30 iterations are nearly the minimum";
}

TEST_F(Rollouts, TellWhenANetworkFails) {
    for (const RolloutResult& result : measure(random_weights(1e4f))) {
        if (result.iterations > 0) continue;
        EXPECT_LT(result.held, 8);
        EXPECT_TRUE(result.failure == "torn" || result.failure == "lost") << result.failure;
        EXPECT_GT(result.distance, RolloutResult::lost_distance * (8 - result.held) / 8.0 - 1e-9);
    }
}

TEST_F(Rollouts, KeepTheirReferences) {
    const std::vector<RolloutResult> first = measure(random_weights(1.0f));
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(m_folder)) {
        EXPECT_EQ(entry.path().extension(), ".pt");
        ++files;
        std::filesystem::last_write_time(entry.path(), std::filesystem::file_time_type());
    }
    EXPECT_EQ(files, 2u);
    const std::vector<RolloutResult> second = measure(random_weights(1.0f));
    for (size_t k = 0; k < first.size(); ++k) EXPECT_EQ(first[k].distance, second[k].distance);
    for (const auto& entry : std::filesystem::directory_iterator(m_folder)) {
        EXPECT_EQ(std::filesystem::last_write_time(entry.path()), std::filesystem::file_time_type())
            << "was not computed again";
        std::filesystem::resize_file(entry.path(), 100);
    }
    EXPECT_EQ(measure(random_weights(1.0f))[0].distance, first[0].distance)
        << "a damaged file is made again";
}

TEST_F(Rollouts, StopWhenTold) {
    RolloutValidation validation(m_factory, m_settings, m_folder);
    EXPECT_FALSE(validation.measure(random_weights(1.0f), m_stop));
    EXPECT_FALSE(std::filesystem::exists(m_folder)) << "no half references";
    EXPECT_TRUE(validation.measure(random_weights(1.0f), m_go));
    EXPECT_FALSE(validation.measure(random_weights(1.0f), m_stop));
}

TEST_F(Rollouts, SummariseEachNumberOfIterations) {
    RolloutResult a, b, shirt;
    shirt.garment = "tshirt";
    a.held = 10;
    b.held = 20;
    a.distance = 0.01;
    b.distance = 0.03;
    shirt.held = 90;
    shirt.iterations = 3;
    const std::vector<RolloutResult> results = {a, b, shirt};
    EXPECT_DOUBLE_EQ(summarise(results, true, 0).held, 15.0);
    EXPECT_DOUBLE_EQ(summarise(results, true, 0).distance_mm, 20.0);
    EXPECT_DOUBLE_EQ(summarise(results, false, 3).held, 90.0);
    EXPECT_TRUE(std::isnan(summarise(results, false, 0).held));
}

TEST_F(Rollouts, DressEachGarment) {
    SceneSettings scenes;
    scenes.garments = {"skirt_1000", "shorts_1000", "tshirt_1000"};
    scenes.motions = {"01_03"};
    const SceneFactory factory(tiny_model(), scenes, 1);
    if (!factory.has_garments()) GTEST_SKIP() << "no body or motions here";
    m_settings.sheet_vertices = 0;
    m_settings.frames = 1;
    m_settings.reference_iterations = 1;
    m_settings.iterations = {1};
    m_settings.clips = {"01_01"};
    const auto dressed = [&](std::vector<std::string> garments) {
        m_settings.garments = std::move(garments);
        std::string all;
        RolloutValidation validation(factory, m_settings, m_folder);
        const auto results = validation.measure(random_weights(0.0f), m_go);
        for (const RolloutResult& result : *results) {
            EXPECT_FALSE(result.is_sheet());
            all += result.scene + " " + result.garment + "; ";
        }
        return all;
    };
    EXPECT_EQ(dressed({"shorts_1000", "skirt_1000"}), "01_01 shorts_1000; 01_01 skirt_1000; ");
    EXPECT_EQ(dressed({}), "01_01 tshirt_1000; ") << "the last one there";
    EXPECT_EQ(refusal(factory, {"shorts_1000", "toga"}, {}),
              "--validation-garments: toga is not trained on. Remedy: choose among skirt_1000, "
              "shorts_1000, tshirt_1000");
}

TEST_F(Rollouts, RefuseNamesThatAreNotThereAtOnce) {
    EXPECT_NE(refusal(m_factory, {}, {"01_0l"}).find("--validation-clips: 01_0l: no motion"),
              std::string::npos);
    EXPECT_NE(refusal(m_factory, {"tshirt"}, {}).find("--garment-share"), std::string::npos)
        << "without garment scenes";
}

/// Some frames of clip 01_03.
void write_clip(const std::string& file, int first) {
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    constexpr int frames = 24;
    std::ifstream whole(model_path("BVH/01_03.bvh"));
    std::ofstream out(file);
    std::string line;
    while (std::getline(whole, line) && line.rfind("Frames:", 0) != 0) out << line << '\n';
    out << "Frames: " << frames << '\n';
    std::getline(whole, line);  // the time of a frame
    out << line << '\n';
    for (int frame = 0; frame < first + frames; ++frame) {
        std::getline(whole, line);
        if (frame >= first) out << line << '\n';
    }
}

TEST_F(Rollouts, ClipsOfOneFileNameAreToldApart) {
    const std::string early = m_folder + "/early/walk.bvh", late = m_folder + "/late/walk.bvh";
    write_clip(early, 100);
    write_clip(late, 300);
    SceneSettings scenes;
    scenes.garments = {"tshirt_1000"};
    scenes.motions = {early};
    const SceneFactory factory(tiny_model(), scenes, 1);
    m_settings.sheet_vertices = 0;
    m_settings.frames = 2;
    m_settings.reference_iterations = 1;
    m_settings.iterations = {0};
    m_settings.clips = {early, late};
    const std::string kept = m_folder + "/references";
    const auto results =
        RolloutValidation(factory, m_settings, kept).measure(random_weights(0.0f), m_go);
    ASSERT_EQ(results->size(), 2u);
    EXPECT_EQ(results->at(0).scene, early);
    EXPECT_EQ(results->at(1).scene, late);
    const auto files = [&] {
        return std::distance(std::filesystem::directory_iterator(kept),
                             std::filesystem::directory_iterator());
    };
    EXPECT_EQ(files(), 2);
    m_settings.clips = {early};
    const auto scene_of = [&] {
        return RolloutValidation(factory, m_settings, kept)
            .measure(random_weights(0.0f), m_go)
            ->at(0)
            .scene;
    };
    EXPECT_EQ(scene_of(), "walk");
    EXPECT_EQ(files(), 2) << "the reference is found again";
    write_clip(early, 200);
    scene_of();
    EXPECT_EQ(files(), 3) << "a clip that was edited has a reference of its own";
}

TEST(ReferenceFingerprints, TellPinsFacesAndSurroundingsApart) {
    const SceneFactory factory(tiny_model(), sheets_only(), 1);
    const auto print = [&](const std::function<void(SceneParts&)>& change) {
        SceneParts parts = make_test_sheet(60, true);
        change(parts);
        return reference_fingerprint(*factory.finish(std::move(parts)), 4);
    };
    const auto with = [](SceneParts& parts, TriMesh rest, std::vector<int> pins) {
        parts.garment = std::make_shared<const Garment>("sheet", std::move(rest),
                                                        Fabric::soft_cotton(), std::move(pins));
    };
    const std::uint64_t plain = print([](SceneParts&) {});
    EXPECT_EQ(print([](SceneParts&) {}), plain);
    EXPECT_NE(print([&](SceneParts& parts) { with(parts, parts.garment->rest(), {0}); }), plain);
    EXPECT_NE(print([&](SceneParts& parts) {
                  TriMesh rest = parts.garment->rest();
                  rest.faces.row(0) = rest.faces.row(1).eval();
                  rest.faces.row(1) = parts.garment->rest().faces.row(0);
                  with(parts, rest, parts.garment->pins());
              }),
              plain);
    EXPECT_NE(
        print([](SceneParts& parts) { parts.world = std::move(make_test_sheet(60, false).world); }),
        plain);
}

TEST(Validation, TakesTheSameTimesAtEachRate) {
    const auto times = [](double rate) {
        ModelConfig model = tiny_model();
        model.dt = 1.0 / rate;
        ValidationSettings settings;
        settings.garment_states = 0;
        settings.sheet_states = 4;
        settings.minimum_iterations = settings.rollout_iterations = 1;
        return Validation(SceneFactory(model, sheets_only(), 1), settings).times();
    };
    const std::vector<double> at_30 = times(30.0), at_60 = times(60.0);
    ASSERT_EQ(at_30.size(), 4u);
    ASSERT_EQ(at_60.size(), 4u);
    for (size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(at_30[k], k % 2 == 0 ? 5.0 / 30.0 : 0.5, 1e-9);
        EXPECT_NEAR(at_60[k], at_30[k], 1e-9);
    }
}

TEST_F(Rollouts, RefuseSettingsOutOfRange) {
    m_settings.frames = 0;
    EXPECT_THROW(RolloutValidation(m_factory, m_settings, m_folder), ArgumentError);
    m_settings.frames = 8;
    m_settings.iterations = {101};
    EXPECT_THROW(RolloutValidation(m_factory, m_settings, m_folder), ArgumentError);
}

}  // namespace
}  // namespace cloth::rollout_validation_test
