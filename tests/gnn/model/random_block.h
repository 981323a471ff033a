#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "gnn/model/message_block.h"

namespace cloth::test {

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

    Result fast(Instructions instructions, Panels panels = {}) const {
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

inline double relative_difference(const Numbers& a, const Numbers& b) {
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

inline std::string name_of(const ::testing::TestParamInfo<Instructions>& info) {
    switch (info.param) {
        case Instructions::avx512_bf16:
            return "Avx512Bf16";
        case Instructions::avx512:
            return "Avx512";
        case Instructions::avx2:
            return "Avx2";
        default:
            return "Portable";
    }
}

inline auto all_instructions() {
    return ::testing::Values(Instructions::portable, Instructions::avx2, Instructions::avx512,
                             Instructions::avx512_bf16);
}

}  // namespace cloth::test
