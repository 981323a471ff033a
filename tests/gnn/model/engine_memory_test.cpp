// What the engine asks of memory: nothing per frame, shared weights, and no more than it reports.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "data/authoring/sheet.h"
#include "gnn/model/engine.h"
#include "tests/address_sanitizer.h"
#include "tests/gnn/model/random_weights.h"

#if CLOTH_ADDRESS_SANITIZER
#define CLOTH_COUNTS_ALLOCATIONS 0
#else
#define CLOTH_COUNTS_ALLOCATIONS 1
static std::atomic<long> allocations{0};
extern "C" void* __libc_malloc(size_t);
extern "C" void* __libc_memalign(size_t, size_t);
extern "C" void* malloc(size_t bytes) {
    ++allocations;
    return __libc_malloc(bytes);
}
extern "C" void* aligned_alloc(size_t alignment, size_t bytes) {
    ++allocations;
    return __libc_memalign(alignment, bytes);
}
#endif

namespace cloth::engine_memory_test {
namespace {

using namespace test;

/// A sheet without surroundings; its features are zeros but for a few numbers.
struct Input {
    explicit Input(const ModelConfig& config, int vertices = 900)
        : garment("sheet", make_sheet(0.6, 0.6, vertices), Fabric::soft_cotton(), {}),
          graph(build_cloth_graph(garment, config.graph_settings())) {
        const Eigen::Index v = graph.vertex_count;
        features.node.setConstant(v, feature_count(node_layout(true)), 0.1f);
        features.edge.setConstant(graph.edge_count(), feature_count(edge_layout()), 0.2f);
        features.world.setConstant(v, feature_count(world_layout()), 0.3f);
        features.body.setConstant(v, feature_count(body_layout()), 0.4f);
        features.world_mask.setOnes(v);
        features.any_world = true;
    }
    Garment garment;
    ClothGraph graph;
    Features features;
};

ModelConfig config_of(const std::string& variant, int width) {
    ModelConfig config = ModelConfig::variant_named(variant);
    config.width = width;
    return config;
}

class EngineMemoryOf : public ::testing::TestWithParam<const char*> {};

TEST_P(EngineMemoryOf, NothingIsAllocatedOnceTheGarmentIsKnown) {
#if CLOTH_COUNTS_ALLOCATIONS
    const ModelConfig config = config_of(GetParam(), 32);
    Input input(config);
    Engine engine(random_weights(config), {2});
    Points out;
    engine.predict(input.graph, input.features, out);
    const size_t bytes = engine.memory().total();
    const long before = allocations;
    for (int k = 0; k < 3; ++k) {
        input.features.world_mask.head(10 * k).setZero();
        engine.predict(input.graph, input.features, out);
    }
    EXPECT_EQ(allocations, before);
    EXPECT_EQ(engine.memory().total(), bytes);
    EXPECT_TRUE(out.allFinite());
#else
    GTEST_SKIP() << "the sanitizer has its own allocator";
#endif
}

TEST_P(EngineMemoryOf, WeightsAreSharedAndCountedOnce) {
    const ModelConfig config = config_of(GetParam(), 32);
    const auto weights = std::make_shared<const EngineWeights>(random_weights(config));
    Engine one(weights), other(weights);
    EXPECT_EQ(one.memory().weights, weights->bytes());
    EXPECT_EQ(weights.use_count(), 3);
    size_t numbers = 0;
    for (const auto& [name, shape] : parameter_shapes(config)) {
        size_t count = 1;
        for (const int extent : shape) count *= static_cast<size_t>(extent);
        numbers += count;
    }
    // Panels are the matrices again; inputs are filled up to a multiple of 16.
    EXPECT_GE(weights->bytes(), sizeof(float) * numbers);
    EXPECT_LE(weights->bytes(), sizeof(float) * numbers * 11 / 10);
}

INSTANTIATE_TEST_SUITE_P(Variants, EngineMemoryOf,
                         ::testing::Values("baseline", "sampling", "reduction", "fast", "hood",
                                           "hood_fast", "bistride"));

TEST(EngineMemory, FastAtFullSizeNeedsLessThan48MB) {
    const ModelConfig config = config_of("fast", 128);
    const Input input(config, 4000);
    Engine engine(random_weights(config), {2});
    Points out;
    engine.predict(input.graph, input.features, out);
    EXPECT_TRUE(out.allFinite());
    EXPECT_LT(engine.memory().total(), 48'000'000u);
}

TEST(EngineMemory, AGarmentWithoutVerticesOrEdgesIsNoTrouble) {
    const ModelConfig config = config_of("fast", 32);
    Engine engine(random_weights(config), {2});
    ClothGraph empty;
    empty.id = 12345;
    empty.first_edge = {0};
    empty.schedule.edges.resize(static_cast<size_t>(config.steps));
    Features features;
    features.node.resize(0, feature_count(node_layout(true)));
    features.edge.resize(0, feature_count(edge_layout()));
    Points out;
    engine.predict(empty, features, out);
    EXPECT_EQ(out.rows(), 0);
}

}  // namespace
}  // namespace cloth::engine_memory_test
