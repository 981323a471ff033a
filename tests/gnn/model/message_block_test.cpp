// The fused kernels against plain loops, for every instruction set of this processor, and their
// gradients against finite differences.

#include "gnn/model/message_block.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "tests/gnn/model/random_block.h"

namespace cloth::message_block_test {
namespace {

using namespace test;

const std::vector<Shape> shapes = {
    {16, {16}, 2, false, 100},
    {32, {32}, 2, true, 131},
    {32, {32, 32, 32}, 0, false, 97},
    {48, {48, 48}, 0, true, 5},
    {64, {32}, 0, false, 1},
    {80, {80, 16, 80}, 1, true, 50},
    {96, {96}, 2, false, 49},
    {128, {128, 128, 128}, 0, true, 77},
    {32, {32, 32, 32, 32}, 0, true, 61},
};

TEST_P(EveryInstructionSet, EqualsThePlainLoops) {
    for (const Shape& shape : shapes) {
        SCOPED_TRACE("width " + std::to_string(shape.width));
        const Block block(shape);
        const Block::Result expected = block.plain(), actual = block.fast(GetParam());
        EXPECT_LT(relative_difference(actual.out, expected.out), 1e-5);
        EXPECT_LT(relative_difference(actual.sum, expected.sum), 1e-5);
    }
}

TEST_P(EveryInstructionSet, PackedWeightsGiveTheSameBits) {
    for (const Shape& shape : shapes) {
        const Block block(shape);
        Numbers panels(block_panel_count(block.weights));
        pack_block(block.weights, panels.data());
        const Block::Result raw = block.fast(GetParam());
        const Block::Result packed = block.fast(GetParam(), panels.data());
        EXPECT_EQ(raw.out, packed.out);
        EXPECT_EQ(raw.sum, packed.sum);
    }
}

TEST_P(EveryInstructionSet, ARowDoesNotDependOnTheRowsBesideIt) {
    const Block block({32, {32}, 2, false, 131});
    const Block::Result all = block.fast(GetParam());
    for (const int from : {0, 1, 7, 63, 130}) {
        Block part = block;
        part.rows.rows = 131 - from;
        part.rows.x[0] += from * 32;
        part.rows.sum_index += from;
        for (int k = 0; k < 2; ++k) part.rows.p_index[k] += from;
        const Block::Result some = part.fast(GetParam());
        EXPECT_EQ(0, std::memcmp(some.out.data(), all.out.data() + from * 32,
                                 sizeof(float) * 32 * static_cast<size_t>(131 - from)));
    }
}

TEST_P(EveryInstructionSet, AMissingInputCountsAsZeros) {
    Block block({32, {32, 32, 32}, 0, false, 60});
    Block with_zeros = block;
    const Numbers zeros(60 * 32, 0.0f);
    with_zeros.rows.x[1] = zeros.data();
    block.rows.x[1] = nullptr;
    const Block::Result expected = with_zeros.plain();
    EXPECT_LT(relative_difference(block.fast(GetParam()).out, expected.out), 1e-5);
    EXPECT_EQ(block.plain().out, expected.out);
}

TEST_P(EveryInstructionSet, DenseLayerEqualsPlainLoops) {
    for (const int out : {16, 32, 48, 128}) {
        Block block({out, {64}, 0, false, 53});
        const float *weight = block.weights.w1[0], *x = block.rows.x[0], *bias = block.weights.b1;
        Numbers panels(static_cast<size_t>(out * 64)), y(static_cast<size_t>(53 * out));
        MessageBlockScratch scratch;
        pack_panels(weight, out, 64, panels.data());
        for (const bool with_relu : {true, false}) {
            dense_layer(53, 64, out, x, panels.data(), bias, with_relu, y.data(), scratch,
                        GetParam());
            for (int r = 0; r < 53; ++r)
                for (int o = 0; o < out; ++o) {
                    double sum = bias[o];
                    for (int i = 0; i < 64; ++i) sum += double(weight[o * 64 + i]) * x[r * 64 + i];
                    if (with_relu) sum = std::max(sum, 0.0);
                    EXPECT_NEAR(y[static_cast<size_t>(r * out + o)], sum, 1e-4);
                }
        }
    }
}

/// A weighted sum of everything the block puts out, in place of a loss.
double loss(const Block& block, Instructions instructions, const Numbers& d_out,
            const Numbers& d_sum) {
    const Block::Result result = block.fast(instructions);
    double total = 0.0;
    for (size_t k = 0; k < d_out.size(); ++k) total += double(d_out[k]) * double(result.out[k]);
    for (size_t k = 0; k < d_sum.size(); ++k) total += double(d_sum[k]) * double(result.sum[k]);
    return total;
}

TEST_P(EveryInstructionSet, GradientsEqualFiniteDifferences) {
    const Shape shape{32, {32, 16}, 2, true, 37};
    Block block(shape);
    const size_t rows = Block::vertices;
    Numbers up_out(rows * 32), up_sum(rows * 32);
    std::mt19937 random(9);
    std::normal_distribution<float> normal(0.0f, 1.0f);
    for (Numbers* values : {&up_out, &up_sum})
        for (float& value : *values) value = normal(random);

    struct Checked {
        const float* value;
        size_t count;
        Numbers gradient;
    };
    std::vector<Checked> checked = {
        {block.rows.x[1], rows * 16, {}},   {block.rows.p[0], rows * 32, {}},
        {block.rows.p[1], rows * 32, {}},   {block.weights.w1[0], 32 * 32, {}},
        {block.weights.w1[1], 32 * 16, {}}, {block.weights.w2, 32 * 32, {}},
        {block.weights.w3, 32 * 32, {}},    {block.weights.b1, 32, {}},
        {block.weights.b2, 32, {}},         {block.weights.b3, 32, {}},
        {block.weights.gamma, 32, {}},      {block.weights.beta, 32, {}},
    };
    for (Checked& one : checked) one.gradient.assign(one.count, 0.0f);
    MessageBlockGradients g;
    g.x[1] = checked[0].gradient.data();
    g.p[0] = checked[1].gradient.data();
    g.p[1] = checked[2].gradient.data();
    g.w1[0] = checked[3].gradient.data();
    g.w1[1] = checked[4].gradient.data();
    g.w2 = checked[5].gradient.data();
    g.w3 = checked[6].gradient.data();
    g.b1 = checked[7].gradient.data();
    g.b2 = checked[8].gradient.data();
    g.b3 = checked[9].gradient.data();
    g.gamma = checked[10].gradient.data();
    g.beta = checked[11].gradient.data();
    MessageBlockScratch scratch;
    message_block_backward(block.weights, block.rows, up_out.data(), up_sum.data(), g, scratch,
                           GetParam());
    for (size_t which = 0; which < checked.size(); ++which) {
        // Along random directions: kinks of the activations average out, roundoff too.
        Checked& one = checked[which];
        Numbers direction(one.count);
        for (float& value : direction) value = normal(random);
        float* values = const_cast<float*>(one.value);
        const Numbers before(values, values + one.count);
        const float step = 2e-3f / std::sqrt(static_cast<float>(one.count));
        double side[2];
        for (const int sign : {0, 1}) {
            for (size_t k = 0; k < one.count; ++k)
                values[k] = before[k] + (sign ? step : -step) * direction[k];
            side[sign] = loss(block, GetParam(), up_out, up_sum);
        }
        std::copy(before.begin(), before.end(), values);
        double expected = 0.0;
        for (size_t k = 0; k < one.count; ++k)
            expected += double(one.gradient[k]) * double(direction[k]);
        const double actual = (side[1] - side[0]) / (2.0 * double(step));
        EXPECT_NEAR(actual, expected, 0.02 * std::abs(expected) + 0.5) << "tensor " << which;
    }
}

INSTANTIATE_TEST_SUITE_P(MessageBlock, EveryInstructionSet, all_instructions(), name_of);

}  // namespace
}  // namespace cloth::message_block_test
