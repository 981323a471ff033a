// The kernels in bfloat16 against plain loops on rounded numbers, and whole networks against
// float32.

#include "gnn/model/bfloat16.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/sheet.h"
#include "gnn/model/engine.h"
#include "tests/gnn/model/random_block.h"
#include "tests/gnn/model/random_weights.h"

namespace cloth::bfloat16_test {
namespace {

using namespace test;

double rounded(double value) {
    return static_cast<double>(to_float(to_bfloat16(static_cast<float>(value))));
}

TEST(Bfloat16, RoundsToNearestAndTiesToEven) {
    EXPECT_EQ(rounded(1.0), 1.0);
    EXPECT_EQ(rounded(-3.140625), -3.140625);
    EXPECT_EQ(rounded(1.0 + 0x1p-8), 1.0);               // a tie, down
    EXPECT_EQ(rounded(1.0 + 3 * 0x1p-8), 1.0 + 0x1p-6);  // a tie, up
    EXPECT_EQ(rounded(1.0 + 0x1p-8 + 0x1p-20), 1.0 + 0x1p-7);
    EXPECT_EQ(rounded(std::numeric_limits<float>::infinity()),
              std::numeric_limits<double>::infinity());
    EXPECT_EQ(rounded(std::numeric_limits<float>::max()), std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(rounded(std::numeric_limits<float>::quiet_NaN())));
}

using Doubles = std::vector<double>;

/// y += W x, both rounded.
void add_rounded_product(const double* weight, const Doubles& x, Doubles& y) {
    for (size_t o = 0; o < y.size(); ++o)
        for (size_t i = 0; i < x.size(); ++i)
            y[o] += rounded(weight[o * x.size() + i]) * rounded(x[i]);
}

void cut(Doubles& values) {
    for (double& value : values) value = std::max(value, 0.0);
}

/// W3 and b3 less the means over their outputs.
struct Centred {
    explicit Centred(const MessageBlockWeights& w) {
        const size_t d = static_cast<size_t>(w.width);
        weight.assign(w.w3, w.w3 + d * d);
        bias.assign(w.b3, w.b3 + d);
        for (size_t i = 0; i <= d; ++i) {
            double mean = 0.0;
            for (size_t o = 0; o < d; ++o) mean += at(o, i);
            mean /= static_cast<double>(d);  // in float32, as the panels are made
            for (size_t o = 0; o < d; ++o)
                at(o, i) -= static_cast<double>(static_cast<float>(mean));
        }
    }
    double& at(size_t o, size_t i) {
        return i == bias.size() ? bias[o] : weight[o * bias.size() + i];
    }
    Doubles weight, bias;
};

Doubles rounded_message(const Block& block, const Centred& third, int r) {
    const MessageBlockWeights& w = block.weights;
    const MessageBlockRows& rows = block.rows;
    const size_t d = block.d, row = static_cast<size_t>(r);
    Doubles h1(w.b1, w.b1 + d), h2(w.b2, w.b2 + d), y = third.bias;
    for (int k = 0; k < w.inputs; ++k) {
        const size_t n = static_cast<size_t>(w.in[k]);
        const float* x =
            rows.x[k] + n * (rows.x_index[k] ? static_cast<size_t>(rows.x_index[k][r]) : row);
        add_rounded_product(Doubles(w.w1[k], w.w1[k] + d * n).data(), Doubles(x, x + n), h1);
    }
    for (int k = 0; k < rows.products; ++k)
        for (size_t o = 0; o < d; ++o)
            h1[o] += double(rows.p[k][static_cast<size_t>(rows.p_index[k][r]) * d + o]);
    cut(h1);
    add_rounded_product(Doubles(w.w2, w.w2 + d * d).data(), h1, h2);
    cut(h2);
    add_rounded_product(third.weight.data(), h2, y);
    double variance = 0.0;
    for (const double value : y) variance += value * value / static_cast<double>(d);
    for (size_t o = 0; o < d; ++o)
        y[o] = y[o] / std::sqrt(variance + 1e-5) * double(w.gamma[o]) + double(w.beta[o]);
    return y;
}

Block::Result rounded_plain(const Block& block) {
    Block::Result result = block.zeros();
    const Centred third(block.weights);
    for (int r = 0; r < block.rows.rows; ++r) {
        const Doubles message = rounded_message(block, third, r);
        const int* index = block.rows.x_index[0];
        const size_t edge = static_cast<size_t>(index ? index[r] : r) * block.d;
        const size_t receiver = static_cast<size_t>(block.rows.sum_index[r]) * block.d;
        for (size_t o = 0; o < block.d; ++o) {
            result.out[edge + o] = block.rows.x[0][edge + o] + static_cast<float>(message[o]);
            result.sum[receiver + o] += 0.4f * static_cast<float>(message[o]);
        }
    }
    return result;
}

/// Rows that are not equal to 1e-6. There are a few: a sum in float32 that ends on the other side
/// of a tie than the exact one makes an activation its other neighbour in bfloat16.
int rows_apart(const Numbers& a, const Numbers& b, size_t d) {
    int apart = 0;
    for (size_t first = 0; first < a.size(); first += d) {
        double difference = 0.0, size = 0.0;
        for (size_t k = first; k < first + d; ++k) {
            difference = std::max(difference, std::abs(double(a[k]) - double(b[k])));
            size = std::max(size, std::abs(double(b[k])));
        }
        if (!(difference <= 1e-6 * size)) ++apart;
    }
    return apart;
}

AlignedHalves packed(const Block& block) {
    AlignedHalves panels(block_panel_count(block.weights));
    pack_block(block.weights, panels.data());
    return panels;
}

const std::vector<Shape> shapes = {
    {16, {16}, 2, false, 100},
    {16, {16, 16}, 0, true, 7},
    {32, {32}, 2, true, 131},
    {32, {32, 32, 32}, 0, true, 97},
    {48, {48, 48}, 0, true, 5},
    {64, {64}, 2, true, 61},
    {80, {80, 16, 80}, 1, true, 50},
    {128, {128}, 2, true, 49},
    {128, {128, 128, 128}, 0, true, 77},
};

TEST_P(EveryInstructionSet, EqualsPlainLoopsOnRoundedNumbers) {
    for (const Shape& shape : shapes) {
        SCOPED_TRACE("width " + std::to_string(shape.width));
        const Block block(shape);
        const AlignedHalves panels = packed(block);
        const Block::Result expected = rounded_plain(block),
                            actual = block.fast(GetParam(), panels.data());
        EXPECT_LT(relative_difference(actual.out, expected.out), 5e-4);
        EXPECT_LT(relative_difference(actual.sum, expected.sum), 5e-4);
        EXPECT_LE(rows_apart(actual.out, expected.out, block.d), 2);
    }
}

TEST_P(EveryInstructionSet, ARoundedRowDoesNotDependOnTheRowsBesideIt) {
    for (const int width : {32, 48, 128}) {
        const size_t d = static_cast<size_t>(width);
        const Block block({width, {width}, 2, false, 131});
        const AlignedHalves panels = packed(block);
        const Numbers all = block.fast(GetParam(), panels.data()).out;
        for (const int from : {1, 7, 63, 130}) {
            Block part = block;
            part.rows.rows = 131 - from;
            part.rows.x[0] += from * width;
            part.rows.sum_index += from;
            for (const int*& index : part.rows.p_index) index += from;
            const Numbers some = part.fast(GetParam(), panels.data()).out;
            const size_t count = static_cast<size_t>(131 - from) * d;
            EXPECT_TRUE(std::equal(some.begin(), some.begin() + static_cast<long>(count),
                                   all.begin() + from * width));
        }
    }
}

TEST_P(EveryInstructionSet, RoundedDenseLayerEqualsPlainLoops) {
    for (const int out : {16, 32, 48, 128}) {
        const Block block({out, {64}, 0, false, 53});
        const float *weight = block.weights.w1[0], *x = block.rows.x[0], *bias = block.weights.b1;
        AlignedHalves panels(static_cast<size_t>(out * 64));
        Numbers y(static_cast<size_t>(53 * out));
        MessageBlockScratch scratch;
        pack_panels(weight, out, 64, panels.data());
        for (const bool with_relu : {true, false}) {
            dense_layer(53, 64, out, x, panels.data(), bias, with_relu, y.data(), scratch,
                        GetParam());
            for (int r = 0; r < 53; ++r) {
                Doubles expected(bias, bias + out);
                add_rounded_product(Doubles(weight, weight + out * 64).data(),
                                    Doubles(x + r * 64, x + r * 64 + 64), expected);
                if (with_relu) cut(expected);
                for (int o = 0; o < out; ++o)
                    EXPECT_NEAR(y[static_cast<size_t>(r * out + o)],
                                expected[static_cast<size_t>(o)], 1e-5);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Bfloat16, EveryInstructionSet, all_instructions(), name_of);

/// A sheet with random features, two thirds of its vertices near a body.
struct Input {
    explicit Input(const ModelConfig& config)
        : garment("sheet", make_sheet(0.6, 0.6, 700), Fabric::soft_cotton(), {}),
          graph(build_cloth_graph(garment, config.graph_settings())) {
        const Eigen::Index v = graph.vertex_count;
        fill(features.node, v, feature_count(node_layout(true)));
        fill(features.edge, graph.edge_count(), feature_count(edge_layout()));
        fill(features.world, v, feature_count(world_layout()));
        fill(features.body, v, feature_count(body_layout()));
        features.world_mask.setZero(v);
        for (Eigen::Index i = 0; i < v; ++i) features.world_mask[i] = i % 3 ? 1.0f : 0.0f;
        features.any_world = true;
    }
    void fill(MatrixF& matrix, Eigen::Index rows, int columns) {
        matrix.resize(rows, columns);
        std::normal_distribution<float> normal;
        for (Eigen::Index k = 0; k < matrix.size(); ++k) matrix.data()[k] = normal(random);
    }
    std::mt19937 random{4};
    Garment garment;
    ClothGraph graph;
    Features features;
};

Points predict(const Weights& weights, Precision precision, const EngineSettings& settings,
               const Input& input) {
    Engine engine(std::make_shared<const EngineWeights>(weights, precision), settings);
    Points out;
    engine.predict(input.graph, input.features, out);
    return out;
}

class Bfloat16Network : public ::testing::TestWithParam<const char*> {
 protected:
    ModelConfig config(int width) const {
        ModelConfig config = ModelConfig::variant_named(GetParam());
        config.width = width;
        return config;
    }
};

TEST_P(Bfloat16Network, IsNearFloat32) {
    for (const int width : {16, 32, 64, 128}) {
        const Weights weights = random_weights(config(width));
        const Input input(weights.config);
        const Points exact = predict(weights, Precision::float32, {2}, input);
        const Points fast = predict(weights, Precision::bfloat16, {2}, input);
        const double error = (fast - exact).norm() / exact.norm();
        EXPECT_LT(error, 0.02) << "width " << width;
        EXPECT_GT(error, 1e-5) << "not rounded?";
    }
}

TEST_P(Bfloat16Network, SameBitsForAnyThreadCountAndTwice) {
    const Weights weights = random_weights(config(32));
    const Input input(weights.config);
    const Points one = predict(weights, Precision::bfloat16, {1}, input);
    EXPECT_EQ(one, predict(weights, Precision::bfloat16, {1}, input));
    EXPECT_EQ(one, predict(weights, Precision::bfloat16, {3}, input));
}

TEST_P(Bfloat16Network, EveryInstructionSetGivesNearlyTheSame) {
    const Weights weights = random_weights(config(32));
    const Input input(weights.config);
    const Points portable =
        predict(weights, Precision::bfloat16, {2, Instructions::portable}, input);
    for (const Instructions instructions :
         {Instructions::avx2, Instructions::avx512, Instructions::avx512_bf16}) {
        if (!is_supported(instructions)) continue;
        const Points other = predict(weights, Precision::bfloat16, {2, instructions}, input);
        EXPECT_LT((other - portable).norm(), 0.01 * portable.norm());
    }
}

TEST_P(Bfloat16Network, WeightsTakeHalfTheMemory) {
    const Weights weights = random_weights(config(128));
    const EngineWeights single(weights), half(weights, Precision::bfloat16);
    EXPECT_LT(static_cast<double>(half.bytes()), 0.52 * static_cast<double>(single.bytes()));
    EXPECT_EQ(half.precision(), Precision::bfloat16);
}

INSTANTIATE_TEST_SUITE_P(Variants, Bfloat16Network,
                         ::testing::Values("baseline", "sampling", "reduction", "fast", "hood",
                                           "hood_fast", "bistride"));

}  // namespace
}  // namespace cloth::bfloat16_test
