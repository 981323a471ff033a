#include "gnn/train/network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "gnn/train/message_op.h"
#include "gnn/train/torch_predictor.h"

namespace cloth::network_test {
namespace {

using torch::Tensor;

/// Features with numbers of a plausible size; half of the vertices are near a body.
Features random_features(const ModelConfig& config, const ClothGraph& graph, int seed) {
    std::srand(static_cast<unsigned>(seed));
    Features f;
    const Eigen::Index n = graph.vertex_count;
    f.node = MatrixF::Random(n, feature_count(node_layout(config.features.force_features)));
    f.edge = MatrixF::Random(graph.edge_count(), feature_count(edge_layout()));
    f.world = MatrixF::Random(n, feature_count(world_layout()));
    f.body = MatrixF::Random(n, feature_count(body_layout()));
    f.world_mask = VectorF::Zero(n);
    for (Eigen::Index i = 0; i < n; i += 2) f.world_mask[i] = 1.0f;
    f.any_world = true;
    return f;
}

ModelConfig small(const std::string& variant, int width = 16) {
    ModelConfig config = ModelConfig::variant_named(variant, 3, /*levels=*/1);
    config.width = width;
    return config;
}

Garment sheet() {
    return Garment("sheet", make_sheet(0.3, 0.3, 70), Fabric::soft_cotton());
}

double difference(const Tensor& a, const Tensor& b) {
    return (a - b).abs().max().item<double>();
}

MlpWeights random_mlp(int width, int inputs) {
    MlpWeights w;
    const auto make = [](std::vector<std::int64_t> shape) {
        return (0.4 * torch::randn(shape)).requires_grad_(true);
    };
    for (int k = 0; k < inputs; ++k) w.first.push_back(make({width, width}));
    w.first_bias = make({width});
    w.hidden = {make({width, width})};
    w.hidden_bias = {make({width})};
    w.output = make({width, width});
    w.output_bias = make({width});
    w.norm = make({width});
    w.norm_bias = make({width});
    return w;
}

/// An edge update on a small graph in its three forms.
struct EdgeUpdate {
    explicit EdgeUpdate(int width) {
        torch::manual_seed(5);
        weights = random_mlp(width, 3);
        nodes = torch::randn({4, width}).requires_grad_(true);
        edges = torch::randn({6, width}).requires_grad_(true);
        FusedRows rows;
        rows.rows = 5;  // edge 2 is not sampled
        rows.sums = 4;
        rows.sum_scale = 0.4f;
        rows.x_index = {0, 1, 3, 4, 5};
        rows.product_index[0] = {0, 0, 1, 2, 3};
        rows.product_index[1] = {1, 2, 3, 0, 2};
        rows.sum_index = rows.product_index[0];
        table = std::make_unique<MessageTable>(rows, torch::kCPU);
    }

    std::vector<Tensor> products() const {
        return {torch::mm(nodes, weights.first[0].t()), torch::mm(nodes, weights.first[1].t())};
    }

    /// Textbook form: one matrix on the concatenation [v_receiver, v_sender, e].
    FusedOutput unsplit() const {
        const Tensor w = torch::cat({weights.first[0], weights.first[1], weights.first[2]}, 1);
        const Tensor in = torch::cat(
            {nodes.index_select(0, table->product_index[0]),
             nodes.index_select(0, table->product_index[1]), edges.index_select(0, table->x_index)},
            1);
        const Tensor message = mlp_tail(weights, torch::linear(in, w, weights.first_bias));
        return {edges.index_add(0, table->x_index, message),
                torch::zeros_like(nodes).index_add(0, table->sum_index, 0.4 * message)};
    }

    MlpWeights weights;
    Tensor nodes, edges;
    std::unique_ptr<MessageTable> table;
};

TEST(MessageOp, SplitFirstLayerEqualsTheUnsplitForm) {
    const EdgeUpdate update(16);
    const FusedOutput split = message_op_plain({update.edges}, {2}, update.products(),
                                               update.weights, *update.table, true);
    const FusedOutput unsplit = update.unsplit();
    EXPECT_LT(difference(split.out, unsplit.out), 1e-5);
    EXPECT_LT(difference(split.sum, unsplit.sum), 1e-5);
    EXPECT_EQ(difference(split.out[2], update.edges[2]), 0.0)
        << "an unsampled edge keeps its latent";
}

TEST(MessageOp, FusedEqualsPlainWithGradients) {
    const EdgeUpdate update(32);
    ASSERT_TRUE(fused_block_supports(update.edges));
    std::vector<Tensor> leaves = {update.nodes,
                                  update.edges,
                                  update.weights.first[0],
                                  update.weights.first[2],
                                  update.weights.hidden[0],
                                  update.weights.output_bias,
                                  update.weights.norm};
    const auto gradients = [&](const FusedOutput& result) {
        const Tensor scalar = (result.out * torch::cos(result.out.detach() * 3)).sum() +
                              (result.sum * torch::sin(result.sum.detach() * 5)).sum();
        return torch::autograd::grad({scalar}, leaves);
    };
    const FusedOutput plain = message_op_plain({update.edges}, {2}, update.products(),
                                               update.weights, *update.table, true);
    const FusedOutput fused =
        message_op({update.edges}, {2}, update.products(), update.weights, *update.table, true);
    EXPECT_LT(difference(plain.out, fused.out), 1e-4);
    EXPECT_LT(difference(plain.sum, fused.sum), 1e-4);
    const auto of_plain = gradients(plain), of_fused = gradients(fused);
    for (size_t k = 0; k < leaves.size(); ++k)
        EXPECT_LT(difference(of_plain[k], of_fused[k]),
                  1e-3 * (1.0 + of_plain[k].abs().max().item<double>()))
            << "leaf " << k;
}

class EveryVariant : public testing::TestWithParam<std::string> {};

TEST_P(EveryVariant, UsesAllItsParametersAndLearnsFromThem) {
    const ModelConfig config = small(GetParam());
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    Network network(config, torch::kCPU, 1);
    const Tensor out = network.forward(graph, random_features(config, graph, 2));
    ASSERT_EQ(out.sizes(), torch::IntArrayRef({graph.vertex_count, 3}));
    EXPECT_TRUE(torch::isfinite(out).all().item<bool>());
    out.backward(torch::randn_like(out));
    for (const auto& [name, shape] : parameter_shapes(config))
        EXPECT_GT(network.parameters().view(name).grad().abs().max().item<double>(), 0.0) << name;
    EXPECT_GT(network.parameters().gradient().abs().max().item<double>(), 0.0)
        << "gradients must arrive in the flat buffer";
}

TEST_P(EveryVariant, WorksWithoutAnythingNear) {
    const ModelConfig config = small(GetParam());
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    Features features = random_features(config, graph, 2);
    features.world_mask.setZero();
    Network network(config, torch::kCPU, 1);
    EXPECT_TRUE(torch::isfinite(network.forward(graph, features)).all().item<bool>());
}

TEST_P(EveryVariant, PredictsTheSameAfterSavingAndLoading) {
    const ModelConfig config = small(GetParam());
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    const Features features = random_features(config, graph, 3);
    Network network(config, torch::kCPU, 4);
    NetworkStatistics statistics = network.statistics();
    statistics.edge.mean.setConstant(0.1f);
    statistics.node.deviation.setConstant(2.0f);
    network.set_statistics(statistics);
    const std::string file = testing::TempDir() + "network_" + GetParam() + ".safetensors";
    network.export_weights().save(file);
    Points out;
    make_torch_predictor(Weights::load(file))->predict(graph, features, out);
    torch::NoGradGuard no_grad;
    network.use_plain_operations();  // as the predictor does
    const Tensor expected = network.forward(graph, features).contiguous();
    const Eigen::Map<const MatrixF> map(expected.data_ptr<float>(), expected.size(0), 3);
    EXPECT_EQ((out - map.cast<double>()).cwiseAbs().maxCoeff(), 0.0);
    std::remove(file.c_str());
}

/// Garments of several sizes, one repeated and one with nothing near it.
struct Batch {
    explicit Batch(const ModelConfig& config) {
        for (const int vertices : {70, 9, 200})
            own_graphs.push_back(std::make_unique<ClothGraph>(
                build_cloth_graph(Garment("sheet", make_sheet(0.3, 0.3, vertices, 3u + vertices),
                                          Fabric::soft_cotton()),
                                  config.graph_settings())));
        for (const size_t k : {0, 1, 2, 0}) graphs.push_back(own_graphs[k].get());
        for (size_t k = 0; k < graphs.size(); ++k) {
            own_features.push_back(std::make_unique<Features>(
                random_features(config, *graphs[k], static_cast<int>(k))));
            features.push_back(own_features.back().get());
            seeds.push_back(torch::randn({graphs[k]->vertex_count, 3}));
        }
        own_features[2]->world_mask.setZero();
    }

    std::vector<std::unique_ptr<ClothGraph>> own_graphs;
    std::vector<std::unique_ptr<Features>> own_features;
    std::vector<const ClothGraph*> graphs;
    std::vector<const Features*> features;
    std::vector<Tensor> seeds;  ///< gradients of the outputs
};

double relative(const Tensor& a, const Tensor& b) {
    return ((a.cpu() - b.cpu()).norm() / b.cpu().norm()).item<double>();
}

TEST_P(EveryVariant, TakesABatchAsEachGarmentAlone) {
    for (const bool plain : {false, true}) {
        const ModelConfig config = small(GetParam());
        const Batch batch(config);
        Network network(config, torch::kCPU, 1);
        if (plain) network.use_plain_operations();
        std::vector<Tensor> alone;
        for (size_t k = 0; k < batch.graphs.size(); ++k) {
            alone.push_back(network.forward(*batch.graphs[k], *batch.features[k]));
            alone.back().backward(batch.seeds[k]);
        }
        const Tensor sum = network.parameters().gradient().clone();
        network.parameters().gradient().zero_();
        const Tensor out = network.forward(batch.graphs, batch.features);
        EXPECT_LT(relative(out, torch::cat(alone)), 1e-5);
        out.backward(torch::cat(batch.seeds));
        EXPECT_LT(relative(network.parameters().gradient(), sum), 1e-5);
    }
}

TEST_P(EveryVariant, OnAGpuEqualsTheCpu) {
    if (!torch::cuda::is_available()) GTEST_SKIP() << "no CUDA device, or LibTorch without CUDA";
    for (const int width : {16, 32, 48}) {
        const ModelConfig config = small(GetParam(), width);
        const Batch batch(config);
        Network cpu(config, torch::kCPU, 1), gpu(config, torch::kCUDA, 1);
        for (const bool plain : {false, true}) {
            if (plain) gpu.use_plain_operations();
            for (Network* network : {&cpu, &gpu}) {
                network->parameters().gradient().zero_();
                const Tensor out = network->forward(batch.graphs, batch.features);
                out.backward(torch::cat(batch.seeds).to(out.device()));
            }
            EXPECT_LT(relative(gpu.forward(batch.graphs, batch.features),
                               cpu.forward(batch.graphs, batch.features)),
                      1e-4);
            EXPECT_LT(relative(gpu.parameters().gradient(), cpu.parameters().gradient()), 1e-4)
                << "width " << width << (plain ? " plain" : "");
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Variants, EveryVariant,
                         testing::Values("baseline", "sampling", "reduction", "fast", "hood",
                                         "hood_fast", "bistride"));

TEST(Network, SamplingAsManyEdgesAsThereAreEqualsTakingAll) {
    ModelConfig all = small("reduction"), sampled = all;
    sampled.sampled_edges = 16;
    const ClothGraph graph_all = build_cloth_graph(sheet(), all.graph_settings());
    const ClothGraph graph_sampled = build_cloth_graph(sheet(), sampled.graph_settings());
    const Features features = random_features(all, graph_all, 1);
    Network a(all, torch::kCPU, 9), b(sampled, torch::kCPU, 9);
    EXPECT_LT(difference(a.forward(graph_all, features), b.forward(graph_sampled, features)), 1e-4);
}

TEST(Network, AStepOnACoarseLevelLeavesTheOtherVerticesAsTheyAre) {
    ModelConfig config = small("hood");
    config.steps = 1;
    config.level_schedule = {{1}};
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    const std::vector<int>& nodes = graph.coarse[0].nodes;
    Network network(config, torch::kCPU, 1);
    const Features features = random_features(config, graph, 2);
    const Tensor before = network.forward(graph, features);
    network.parameters().view("step.0.node.output.bias").data() += torch::randn({16});
    const Tensor change = (network.forward(graph, features) - before).abs().sum(1);
    for (int i = 0; i < graph.vertex_count; ++i)
        EXPECT_EQ(change[i].item<double>() != 0.0,
                  std::binary_search(nodes.begin(), nodes.end(), i))
            << "vertex " << i;
}

TEST(Network, CoarseLevelsCarryMessagesFartherThanTheMesh) {
    // Five steps on the mesh reach five edges from the end of a strip.
    const Garment strip("strip", make_sheet(1.0, 0.06, 150), Fabric::soft_cotton());
    const auto reached = [&](const std::string& variant) {
        ModelConfig config = ModelConfig::variant_named(variant, 5);
        config.width = 16;
        const ClothGraph graph = build_cloth_graph(strip, config.graph_settings());
        Network network(config, torch::kCPU, 1);
        Features features = random_features(config, graph, 2);
        features.world_mask.setZero();
        const Tensor before = network.forward(graph, features);
        Eigen::Index end = 0;
        strip.rest().vertices.col(0).minCoeff(&end);
        features.node.row(end).array() += 1.0f;
        const Tensor change = (network.forward(graph, features) - before).abs().sum(1);
        return (change > 0).sum().item<int>();
    };
    EXPECT_GT(reached("hood"), 1.3 * reached("baseline"));
    EXPECT_GT(reached("bistride"), 1.3 * reached("baseline"));
}

TEST(Network, PlainOperationsAgreeWithFusedOnes) {
    // Three hidden layers are beyond the fused operation, width 24 as well: both must still run.
    ModelConfig config = small("baseline", 24);
    config.hidden_layers = 3;
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    Network network(config, torch::kCPU, 1);
    const Tensor out = network.forward(graph, random_features(config, graph, 2));
    EXPECT_TRUE(torch::isfinite(out).all().item<bool>());
    out.sum().backward();
    EXPECT_GT(network.parameters().gradient().norm().item<double>(), 0.0);
}

TEST(Network, FollowsAPermutationOfTheVertices) {
    const ModelConfig config = small("baseline");
    const Garment original = sheet();
    const int n = static_cast<int>(original.vertex_count());
    ASSERT_NE(n % 11, 0);
    const auto moved = [n](int i) { return (11 * i + 2) % n; };
    TriMesh mesh = original.rest();
    for (int i = 0; i < n; ++i) mesh.vertices.row(moved(i)) = original.rest().vertices.row(i);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) mesh.faces(f, k) = moved(original.rest().faces(f, k));
    const ClothGraph a = build_cloth_graph(original, config.graph_settings());
    const ClothGraph b = build_cloth_graph(Garment("permuted", mesh, Fabric::soft_cotton()),
                                           config.graph_settings());
    const Features fa = random_features(config, a, 6);
    Features fb = fa;
    for (int i = 0; i < n; ++i) {
        fb.node.row(moved(i)) = fa.node.row(i);
        fb.world.row(moved(i)) = fa.world.row(i);
        fb.body.row(moved(i)) = fa.body.row(i);
        fb.world_mask[moved(i)] = fa.world_mask[i];
    }
    std::map<std::pair<int, int>, int> edge_of;
    for (int e = 0; e < b.edge_count(); ++e)
        edge_of[{b.receivers[static_cast<size_t>(e)], b.senders[static_cast<size_t>(e)]}] = e;
    for (int e = 0; e < a.edge_count(); ++e)
        fb.edge.row(edge_of.at({moved(a.receivers[static_cast<size_t>(e)]),
                                moved(a.senders[static_cast<size_t>(e)])})) = fa.edge.row(e);
    Network network(config, torch::kCPU, 3);
    const Tensor out_a = network.forward(a, fa), out_b = network.forward(b, fb);
    for (int i = 0; i < n; ++i) EXPECT_LT(difference(out_a[i], out_b[moved(i)]), 1e-4);
}

TEST(Network, StartsNearItsGuess) {
    const ModelConfig config = small("fast", 32);
    const ClothGraph graph = build_cloth_graph(sheet(), config.graph_settings());
    Network network(config, torch::kCPU, 1);
    EXPECT_LT(network.forward(graph, random_features(config, graph, 2)).abs().max().item<double>(),
              0.3);
}

TEST(Network, RefusesWeightsOfAnotherConfiguration) {
    Network fast(small("fast"), torch::kCPU, 1), baseline(small("baseline"), torch::kCPU, 1);
    EXPECT_THROW(fast.import_weights(baseline.export_weights()), ArgumentError);
    Weights shorter = fast.export_weights();
    shorter.tensors.at("statistics.node.mean").data.pop_back();
    EXPECT_THROW(fast.import_weights(shorter), ArgumentError);
    EXPECT_THROW(make_torch_predictor(fast.export_weights(), "tpu"), ArgumentError);
}

}  // namespace
}  // namespace cloth::network_test
