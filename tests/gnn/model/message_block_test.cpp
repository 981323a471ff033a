// The fused kernels against plain loops, for every instruction set of this processor, and their
// gradients against finite differences.

#include "gnn/model/message_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <string>

namespace cloth {
namespace {

using Numbers = AlignedBuffer;

struct Shape {
    int width;
    std::vector<int> in;
    int products;
    bool indexed;
    int rows;
};

/// A block with seeded weights and rows that are drawn from 40 of each matrix.
class Block {
 public:
    static constexpr int vertices = 40;

    explicit Block(const Shape& of) : shape(of), d(static_cast<size_t>(of.width)) {
        weights.width = shape.width;
        weights.inputs = static_cast<int>(shape.in.size());
        rows.rows = shape.rows;
        rows.products = shape.products;
        rows.sum_scale = 0.4f;
        const size_t count = static_cast<size_t>(std::max(vertices, shape.rows));
        for (size_t k = 0; k < shape.in.size(); ++k) {
            const size_t n = static_cast<size_t>(shape.in[k]);
            weights.in[k] = shape.in[k];
            weights.w1[k] = numbers(d * n, 1.0 / std::sqrt(double(n)));
            rows.x[k] = numbers(count * n, 1.0);
            if (shape.indexed) rows.x_index[k] = distinct_rows();
        }
        weights.w2 = numbers(d * d, 1.4 / std::sqrt(double(d)));
        weights.w3 = numbers(d * d, 1.4 / std::sqrt(double(d)));
        for (const float** bias : {&weights.b1, &weights.b2, &weights.b3, &weights.beta})
            *bias = numbers(d, 0.3);
        weights.gamma = numbers(d, 1.0);
        for (int k = 0; k < shape.products; ++k) {
            rows.p[k] = numbers(count * d, 0.5);
            rows.p_index[k] = random_rows();
        }
        std::vector<int>& receivers = m_tables.emplace_back();
        for (int r = 0; r < shape.rows; ++r) receivers.push_back(r * vertices / shape.rows);
        rows.sum_index = receivers.data();
    }

    struct Result {
        Numbers out, sum;
    };

    Result zeros() const {
        return {Numbers(static_cast<size_t>(std::max(vertices, shape.rows)) * d, 0.0f),
                Numbers(static_cast<size_t>(vertices) * d, 0.0f)};
    }

    Result fast(Instructions instructions, const float* panels = nullptr) const {
        Result result = zeros();
        MessageBlockWeights w = weights;
        w.panels = panels;
        MessageBlockScratch scratch;
        message_block_forward(w, rows, result.out.data(), result.sum.data(), scratch, instructions);
        return result;
    }

    Result plain() const {
        Result result = zeros();
        message_block_forward_plain(weights, rows, result.out.data(), result.sum.data());
        return result;
    }

    float* numbers(size_t count, double size) {
        std::normal_distribution<float> normal(0.0f, static_cast<float>(size));
        Numbers& values = m_numbers.emplace_back(count);
        for (float& value : values) value = normal(m_random);
        return values.data();
    }

    Shape shape;
    size_t d;
    MessageBlockWeights weights;
    MessageBlockRows rows;

 private:
    const int* distinct_rows() {
        std::vector<int>& table = m_tables.emplace_back();
        for (int r = 0; r < shape.rows; ++r) table.push_back(r);
        std::shuffle(table.begin(), table.end(), m_random);
        return table.data();
    }

    const int* random_rows() {
        std::vector<int>& table = m_tables.emplace_back();
        for (int r = 0; r < shape.rows; ++r)
            table.push_back(static_cast<int>(m_random() % static_cast<unsigned>(vertices)));
        return table.data();
    }

    std::mt19937 m_random{5};
    std::vector<Numbers> m_numbers = reserved<Numbers>();
    std::vector<std::vector<int>> m_tables = reserved<std::vector<int>>();

    template <typename T>
    static std::vector<T> reserved() {
        std::vector<T> list;
        list.reserve(64);  // pointers into its elements stay valid
        return list;
    }
};

double relative_difference(const Numbers& a, const Numbers& b) {
    double difference = 0.0, size = 0.0;
    for (size_t k = 0; k < a.size(); ++k) {
        difference += std::pow(double(a[k]) - double(b[k]), 2);
        size += std::pow(double(b[k]), 2);
    }
    return std::sqrt(difference / size);
}

class EveryInstructionSet : public ::testing::TestWithParam<Instructions> {
 protected:
    void SetUp() override {
        if (!is_supported(GetParam())) GTEST_SKIP() << "not on this processor";
    }
};

const std::vector<Shape> shapes = {
    {16, {16}, 2, false, 100},        {32, {32}, 2, true, 131},
    {32, {32, 32, 32}, 0, false, 97}, {48, {48, 48}, 0, true, 5},
    {64, {32}, 0, false, 1},          {80, {80, 16, 80}, 1, true, 50},
    {96, {96}, 2, false, 49},         {128, {128, 128, 128}, 0, true, 77},
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
        pack_panels(weight, out, 64, panels.data());
        for (const bool with_relu : {true, false}) {
            dense_layer(53, 64, out, x, panels.data(), bias, with_relu, y.data(), GetParam());
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

std::string name_of(const ::testing::TestParamInfo<Instructions>& info) {
    switch (info.param) {
        case Instructions::avx512:
            return "Avx512";
        case Instructions::avx2:
            return "Avx2";
        default:
            return "Portable";
    }
}

INSTANTIATE_TEST_SUITE_P(MessageBlock, EveryInstructionSet,
                         ::testing::Values(Instructions::portable, Instructions::avx2,
                                           Instructions::avx512),
                         name_of);

}  // namespace
}  // namespace cloth
