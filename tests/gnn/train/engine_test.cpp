// The engine must compute the same function as the LibTorch network, for every variant.

#include "gnn/model/engine.h"

#include <gtest/gtest.h>

#include "collision/proximity/proximity.h"
#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/graph/graph_batch.h"
#include "gnn/physics/stepper/guess.h"
#include "gnn/train/network.h"
#include "gnn/train/torch_predictor.h"

namespace cloth::engine_test {

namespace {

/// A sheet that moves and partly touches a sphere.
struct EngineScene {
    explicit EngineScene(const ModelConfig& config, int vertices = 500, bool with_sphere = true)
        : garment("sheet", make_sheet(0.6, 0.5, vertices), Fabric::soft_cotton(), {0, 1}),
          graph(build_cloth_graph(garment, config.graph_settings())) {
        ClothState state = ClothState::at_rest(garment);
        for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
            state.x.row(i) *= 1.0 + 0.05 * std::sin(static_cast<double>(i));
            state.v.row(i) = Vec3(0.1, -0.5, 0.2 * std::cos(static_cast<double>(i))).transpose();
        }
        Boundary boundary;
        boundary.pin_targets = garment.rest().vertices.topRows(2);
        if (with_sphere) {
            Obstacle sphere;
            sphere.shape = ObstacleShape::sphere;
            sphere.radius = 0.2;
            sphere.pose0.translation() = sphere.pose1.translation() = Vec3(0, -0.21, 0);
            boundary.obstacles.push_back(sphere);
        }
        SurfaceContacts contacts;
        Proximity().query(state.x, boundary, contacts);
        IncrementalPotential potential(garment);
        potential.begin_step(state, boundary, contacts, config.dt);
        Points base;
        starting_guess(garment, state, boundary, contacts, config.dt, 4e-3, base);
        FeatureBuilder(garment, graph, config.features)
            .build(state, boundary, potential, base, features);
    }

    Garment garment;
    ClothGraph graph;
    Features features;
};

ModelConfig small_config(const std::string& variant, int width = 32) {
    ModelConfig config = ModelConfig::variant_named(variant, 5);
    config.width = width;
    return config;
}

std::shared_ptr<const Weights> random_weights(const ModelConfig& config) {
    return std::make_shared<const Weights>(
        Network(config, torch::kCPU, /*seed=*/7).export_weights());
}

Points predict(Predictor& predictor, const EngineScene& scene) {
    Points out;
    predictor.predict(scene.graph, scene.features, out);
    return out;
}

}  // namespace

class EngineVariant : public ::testing::TestWithParam<const char*> {};

TEST_P(EngineVariant, EqualsLibTorch) {
    for (const bool with_sphere : {true, false})
        for (const bool forces : {true, false}) {
            ModelConfig config = small_config(GetParam());
            config.features.force_features = forces;
            const EngineScene scene(config, 500, with_sphere);
            ASSERT_EQ(scene.features.any_world, with_sphere);
            const auto weights = random_weights(config);
            Engine engine(*weights);
            const Points expected = predict(*make_torch_predictor(*weights), scene);
            const Points actual = predict(engine, scene);
            EXPECT_LT((actual - expected).norm(), 1e-5 * expected.norm());
        }
}

TEST_P(EngineVariant, SameBitsForAnyThreadCountAndTwice) {
    const ModelConfig config = small_config(GetParam());
    const EngineScene scene(config);
    const auto weights = random_weights(config);
    const auto shared = std::make_shared<const EngineWeights>(*weights);
    Engine one(shared, {1}), three(shared, {3});
    const Points first = predict(one, scene);
    EXPECT_EQ(first, predict(one, scene));
    EXPECT_EQ(first, predict(three, scene));
}

TEST_P(EngineVariant, EvaluatesABatchOfGarmentsAsEachAlone) {
    const ModelConfig config = small_config(GetParam());
    const auto weights = random_weights(config);
    const EngineScene touching(config, 300), free(config, 130, false), tiny(config, 9);
    const std::vector<const EngineScene*> scenes = {&touching, &tiny, &free, &touching};
    std::vector<const ClothGraph*> graphs;
    std::vector<const Features*> features;
    for (const EngineScene* scene : scenes) {
        graphs.push_back(&scene->graph);
        features.push_back(&scene->features);
    }
    const GraphBatch batch(graphs);
    Features all;
    batch.gather(features, all);
    Engine engine(*weights);
    const auto torch_predictor = make_torch_predictor(*weights);
    for (Predictor* predictor : {static_cast<Predictor*>(&engine), torch_predictor.get()}) {
        Points out;
        predictor->predict(batch.graph(), all, out);
        ASSERT_EQ(out.rows(), batch.graph().vertex_count);
        for (size_t k = 0; k < scenes.size(); ++k) {
            const Points expected = predict(*predictor, *scenes[k]);
            EXPECT_LT((batch.rows_of(k, out) - expected).norm(), 1e-5 * expected.norm());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Variants, EngineVariant,
                         ::testing::Values("baseline", "sampling", "reduction", "fast", "hood",
                                           "hood_fast", "bistride"));

TEST(Engine, TakesWidthsThatAreNotMultiplesOf32) {
    const ModelConfig config = small_config("baseline", 48);
    const EngineScene scene(config, 130);
    const auto weights = random_weights(config);
    Engine engine(*weights);
    const Points expected = predict(*make_torch_predictor(*weights), scene);
    EXPECT_LT((predict(engine, scene) - expected).norm(), 1e-5 * expected.norm());
}

TEST(Engine, TakesAnyNumberOfSampledNeighbours) {
    // 1 to 7, as in the paper's figure 7; vertices of a sheet have 3 to 8.
    for (const char* variant : {"sampling", "fast", "hood_fast"})
        for (int neighbours = 1; neighbours <= 7; ++neighbours) {
            ModelConfig config = small_config(variant);
            config.sampled_edges = neighbours;
            const EngineScene scene(config, 300);
            const auto weights = random_weights(config);
            EXPECT_EQ(weights->config.sampled_edges, neighbours);
            Engine engine(*weights);
            const Points expected = predict(*make_torch_predictor(*weights), scene);
            EXPECT_LT((predict(engine, scene) - expected).norm(), 1e-5 * expected.norm())
                << variant << ", " << neighbours;
        }
}

TEST(Engine, TakesSchedulesThatSkipLevels) {
    // Long edges beside the mesh's in every step, or a step on the coarsest level at the end.
    for (const LevelSchedule& schedule :
         {LevelSchedule{{0, 2}, {0, 2}, {0, 2}}, LevelSchedule{{2}, {1, 3}, {1}},
          LevelSchedule{{1}, {0}, {0, 1}}})
        for (const char* variant : {"hood", "hood_fast", "bistride"}) {
            ModelConfig config = small_config(variant);
            config.steps = 3;
            config.level_schedule = schedule;
            const EngineScene scene(config, 300);
            const auto weights = random_weights(config);
            Engine engine(*weights);
            const Points expected = predict(*make_torch_predictor(*weights), scene);
            EXPECT_LT((predict(engine, scene) - expected).norm(), 1e-5 * expected.norm());
        }
}

TEST(Engine, TakesGarmentsThatAreTooSmallForTheLevels) {
    for (const char* variant : {"hood", "hood_fast", "bistride"})
        for (const int vertices : {9, 30}) {
            ModelConfig config = ModelConfig::variant_named(variant, 9, 4);
            config.width = 32;
            const EngineScene scene(config, vertices);
            EXPECT_TRUE(scene.graph.coarse.back().nodes.empty());
            const auto weights = random_weights(config);
            Engine engine(*weights);
            const Points expected = predict(*make_torch_predictor(*weights), scene);
            ASSERT_TRUE(expected.allFinite());
            EXPECT_LT((predict(engine, scene) - expected).norm(), 1e-5 * expected.norm());
        }
}

TEST(Engine, AGraphWithoutTheLevelsGivesNoFiniteNumber) {
    const ModelConfig flat = small_config("fast"), config = small_config("hood_fast");
    const EngineScene scene(flat, 120);
    const auto weights = random_weights(config);
    Engine engine(*weights);
    EXPECT_FALSE(predict(engine, scene).allFinite());
    EXPECT_FALSE(predict(*make_torch_predictor(*weights), scene).allFinite());
}

TEST(Engine, GraphsAndFeaturesOfOtherSettingsGiveNoFiniteNumber) {
    for (const char* variant : {"fast", "hood_fast"}) {
        const ModelConfig config = small_config(variant);
        const auto weights = random_weights(config);
        const auto change = [&](const auto& set) {
            ModelConfig other = config;
            set(other);
            return other;
        };
        const EngineScene own(config, 120);
        const ModelConfig others[] = {
            change([](ModelConfig& c) { c.sampled_edges = 0; }),
            change([](ModelConfig& c) { c.sampled_edges = 3; }),
            change([&](ModelConfig& c) { c = ModelConfig::variant_named(variant, 6); }),
            change([&](ModelConfig& c) { c = ModelConfig::variant_named(variant, 9); }),
            change([](ModelConfig& c) { c.features.force_features = false; })};
        for (const ModelConfig& other : others) {
            const EngineScene scene(other, 120);
            Engine engine(*weights);
            const auto libtorch = make_torch_predictor(*weights);
            EXPECT_FALSE(predict(engine, scene).allFinite());
            EXPECT_FALSE(predict(*libtorch, scene).allFinite());
            Network network(config, torch::kCPU, 1);
            EXPECT_THROW(network.forward(scene.graph, scene.features), ArgumentError);
            EXPECT_TRUE(predict(engine, own).allFinite()) << "the next one is its own again";
            EXPECT_TRUE(predict(*libtorch, own).allFinite());
        }
    }
}

TEST(Engine, HasTheNameOfItsWeightsAsLibTorchHas) {
    Weights weights = *random_weights(small_config("fast"));
    EXPECT_EQ(Engine(weights).name(), "fast");
    EXPECT_EQ(make_torch_predictor(weights)->name(), "fast");
    weights.called = "small";
    EXPECT_EQ(Engine(weights).name(), "small");
    EXPECT_EQ(make_torch_predictor(weights)->name(), "small");
}

TEST(Engine, FollowsAChangeOfGarment) {
    const ModelConfig config = small_config("fast");
    const auto weights = random_weights(config);
    Engine engine(*weights), fresh(*weights);
    const EngineScene small(config, 120), large(config, 700);
    predict(engine, large);
    EXPECT_EQ(predict(engine, small), predict(fresh, small));
}

TEST(Engine, RefusesWhatItCannotRun) {
    EXPECT_THROW(Engine(*random_weights(small_config("fast", 20))), std::invalid_argument);
    ModelConfig config = small_config("fast");
    config.hidden_layers = 1;
    EXPECT_THROW(Engine{*random_weights(config)}, std::invalid_argument);
}

TEST(Engine, FeaturesOfAnotherGarmentGiveNoFiniteNumber) {
    const ModelConfig config = small_config("fast");
    const EngineScene scene(config, 120), other(config, 200);
    Engine engine(*random_weights(config));
    Points out;
    engine.predict(scene.graph, other.features, out);
    EXPECT_FALSE(out.allFinite());
}

}  // namespace cloth::engine_test
