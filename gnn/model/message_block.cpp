#include "gnn/model/message_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "gnn/model/dense_kernels.h"

namespace cloth {

namespace {

using kernels::at;
using kernels::lane_count;
using kernels::Lanes;
using kernels::load;

constexpr int tile_rows = 64;
constexpr float norm_epsilon = 1e-5f;  // as LibTorch's LayerNorm

/// Buffers of one tile, cut from the caller's scratch.
struct Tile {
    float* x[MessageBlockWeights::max_inputs];  // gathered direct inputs (tile x in[k])
    float *h1, *h2, *normed, *y;                // (tile x D)
    float *d_a, *d_b;                           // (tile x D), backward
    float* inverse_deviation;                   // (tile)
    float *w1t[MessageBlockWeights::max_inputs], *w2t, *w3t;  // transposed weights
};

void transpose(const float* from, int rows, int columns, float* to) {
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) to[c * rows + r] = from[r * columns + c];
}

Tile make_tile(const MessageBlockWeights& w, MessageBlockScratch& scratch) {
    const size_t d = static_cast<size_t>(w.width);
    size_t inputs = 0;
    for (int k = 0; k < w.inputs; ++k) inputs += static_cast<size_t>(w.in[k]);
    const size_t needed = tile_rows * (inputs + 6 * d + 1) + inputs * d + 2 * d * d;
    if (scratch.size() < needed) scratch.resize(needed);
    float* next = scratch.data();
    const auto take = [&next](size_t count) {
        float* taken = next;
        next += count;
        return taken;
    };
    Tile tile{};
    for (int k = 0; k < w.inputs; ++k) tile.x[k] = take(tile_rows * static_cast<size_t>(w.in[k]));
    for (float** buffer : {&tile.h1, &tile.h2, &tile.normed, &tile.y, &tile.d_a, &tile.d_b})
        *buffer = take(tile_rows * d);
    tile.inverse_deviation = take(tile_rows);
    for (int k = 0; k < w.inputs; ++k) {
        tile.w1t[k] = take(d * static_cast<size_t>(w.in[k]));
        transpose(w.w1[k], w.width, w.in[k], tile.w1t[k]);
    }
    tile.w2t = take(d * d);
    transpose(w.w2, w.width, w.width, tile.w2t);
    tile.w3t = take(d * d);
    transpose(w.w3, w.width, w.width, tile.w3t);
    return tile;
}

CLOTH_INLINE size_t row_of(const int* index, int r) {
    return static_cast<size_t>(index ? index[r] : r);
}

CLOTH_INLINE void add_row(int n, const float* from, float* to) {
    for (int i = 0; i < n; i += lane_count) at(to + i) += load(from + i);
}

CLOTH_INLINE void fill_rows(int rows, int n, const float* row, float* to) {
    for (int r = 0; r < rows; ++r) std::memcpy(to + r * n, row, sizeof(float) * n);
}

CLOTH_INLINE void relu(int count, float* x) {
    for (int i = 0; i < count; i += lane_count) {
        const Lanes value = load(x + i);
        at(x + i) = value > 0.0f ? value : Lanes{};
    }
}

/// Zeroes the gradient where the activation was cut off.
CLOTH_INLINE void relu_backward(int count, const float* activation, float* gradient) {
    for (int i = 0; i < count; i += lane_count) {
        const Lanes value = load(activation + i);
        at(gradient + i) = value > 0.0f ? load(gradient + i) : Lanes{};
    }
}

CLOTH_INLINE float row_sum(int n, const float* row) {
    Lanes lanes{};
    for (int i = 0; i < n; i += lane_count) lanes += load(row + i);
    float sum = 0.0f;
    for (int i = 0; i < lane_count; ++i) sum += lanes[i];
    return sum;
}

CLOTH_INLINE float row_dot(int n, const float* a, const float* b) {
    Lanes lanes{};
    for (int i = 0; i < n; i += lane_count) lanes += load(a + i) * load(b + i);
    float sum = 0.0f;
    for (int i = 0; i < lane_count; ++i) sum += lanes[i];
    return sum;
}

/// y -> (y - mean) / deviation, row by row; keeps 1 / deviation for the backward pass.
CLOTH_INLINE void normalise(int rows, int n, const float* y, float* normed, float* inverse) {
    for (int r = 0; r < rows; ++r) {
        const float mean = row_sum(n, y + r * n) / static_cast<float>(n);
        for (int i = 0; i < n; i += lane_count) at(normed + r * n + i) = load(y + r * n + i) - mean;
        const float variance = row_dot(n, normed + r * n, normed + r * n) / static_cast<float>(n);
        inverse[r] = 1.0f / std::sqrt(variance + norm_epsilon);
        for (int i = 0; i < n; i += lane_count) at(normed + r * n + i) *= inverse[r];
    }
}

/// Direct inputs and given products of rows [first, first + count) up to the normalised output.
template <int Block>
CLOTH_INLINE void evaluate_tile(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                int first, int count, const Tile& tile) {
    const int d = w.width;
    fill_rows(count, d, w.b1, tile.h1);
    for (int k = 0; k < w.inputs; ++k) {
        const int n = w.in[k];
        const float* x = rows.x[k] + static_cast<size_t>(first) * n;
        if (rows.x_index[k]) {
            for (int r = 0; r < count; ++r)
                std::memcpy(tile.x[k] + r * n, rows.x[k] + row_of(rows.x_index[k], first + r) * n,
                            sizeof(float) * n);
            x = tile.x[k];
        }
        kernels::multiply<Block>(count, n, d, x, n, tile.w1t[k], d, tile.h1, d);
    }
    for (int k = 0; k < rows.products; ++k)
        for (int r = 0; r < count; ++r)
            add_row(d, rows.p[k] + row_of(rows.p_index[k], first + r) * d, tile.h1 + r * d);
    relu(count * d, tile.h1);
    fill_rows(count, d, w.b2, tile.h2);
    kernels::multiply<Block>(count, d, d, tile.h1, d, tile.w2t, d, tile.h2, d);
    relu(count * d, tile.h2);
    fill_rows(count, d, w.b3, tile.y);
    kernels::multiply<Block>(count, d, d, tile.h2, d, tile.w3t, d, tile.y, d);
    normalise(count, d, tile.y, tile.normed, tile.inverse_deviation);
}

template <int Block>
CLOTH_INLINE void forward(const MessageBlockWeights& w, const MessageBlockRows& rows, float* out,
                          float* sum, MessageBlockScratch& scratch) {
    const Tile tile = make_tile(w, scratch);
    const int d = w.width;
    for (int first = 0; first < rows.rows; first += tile_rows) {
        const int count = std::min(tile_rows, rows.rows - first);
        evaluate_tile<Block>(w, rows, first, count, tile);
        for (int r = 0; r < count; ++r) {
            const size_t edge = row_of(rows.x_index[0], first + r) * d;
            float* sum_row = sum ? sum + row_of(rows.sum_index, first + r) * d : nullptr;
            for (int i = 0; i < d; i += lane_count) {
                const Lanes message =
                    load(tile.normed + r * d + i) * load(w.gamma + i) + load(w.beta + i);
                if (out) at(out + edge + i) = load(rows.x[0] + edge + i) + message;
                if (sum) at(sum_row + i) += rows.sum_scale * message;
            }
        }
    }
}

/// Gradient of the message (tile.d_a), through the LayerNorm, to that of y (tile.d_b).
CLOTH_INLINE void norm_backward(const MessageBlockWeights& w, const MessageBlockGradients& g,
                                int count, const Tile& tile) {
    const int d = w.width;
    for (int r = 0; r < count; ++r) {
        float* message = tile.d_a + r * d;
        const float* normed = tile.normed + r * d;
        for (int i = 0; i < d; i += lane_count) {
            if (g.gamma) at(g.gamma + i) += load(message + i) * load(normed + i);
            if (g.beta) at(g.beta + i) += load(message + i);
            at(message + i) *= load(w.gamma + i);
        }
        const float mean = row_sum(d, message) / static_cast<float>(d);
        const float slope = row_dot(d, message, normed) / static_cast<float>(d);
        for (int i = 0; i < d; i += lane_count)
            at(tile.d_b + r * d + i) =
                tile.inverse_deviation[r] * (load(message + i) - mean - slope * load(normed + i));
    }
}

CLOTH_INLINE void add_columns(int rows, int n, const float* x, float* sum) {
    if (!sum) return;
    for (int r = 0; r < rows; ++r) add_row(n, x + r * n, sum);
}

template <int Block>
CLOTH_INLINE void backward(const MessageBlockWeights& w, const MessageBlockRows& rows,
                           const float* d_out, const float* d_sum, const MessageBlockGradients& g,
                           MessageBlockScratch& scratch) {
    const Tile tile = make_tile(w, scratch);
    const int d = w.width;
    for (int first = 0; first < rows.rows; first += tile_rows) {
        const int count = std::min(tile_rows, rows.rows - first);
        evaluate_tile<Block>(w, rows, first, count, tile);
        for (int r = 0; r < count; ++r) {
            const float* edge = d_out ? d_out + row_of(rows.x_index[0], first + r) * d : nullptr;
            const float* receiver = d_sum ? d_sum + row_of(rows.sum_index, first + r) * d : nullptr;
            for (int i = 0; i < d; i += lane_count) {
                Lanes message{};
                if (edge) message += load(edge + i);
                if (receiver) message += rows.sum_scale * load(receiver + i);
                at(tile.d_a + r * d + i) = message;
            }
        }
        norm_backward(w, g, count, tile);
        // third layer: d_b is the gradient of y
        add_columns(count, d, tile.d_b, g.b3);
        if (g.w3)
            kernels::multiply_transposed<Block>(count, d, d, tile.d_b, d, tile.h2, d, g.w3, d);
        std::memset(tile.d_a, 0, sizeof(float) * count * d);
        kernels::multiply<Block>(count, d, d, tile.d_b, d, w.w3, d, tile.d_a, d);
        relu_backward(count * d, tile.h2, tile.d_a);
        // second layer: d_a is the gradient of its pre-activation
        add_columns(count, d, tile.d_a, g.b2);
        if (g.w2)
            kernels::multiply_transposed<Block>(count, d, d, tile.d_a, d, tile.h1, d, g.w2, d);
        std::memset(tile.d_b, 0, sizeof(float) * count * d);
        kernels::multiply<Block>(count, d, d, tile.d_a, d, w.w2, d, tile.d_b, d);
        relu_backward(count * d, tile.h1, tile.d_b);
        // first layer: d_b is the gradient of its pre-activation
        add_columns(count, d, tile.d_b, g.b1);
        for (int k = 0; k < rows.products; ++k)
            if (g.p[k])
                for (int r = 0; r < count; ++r)
                    add_row(d, tile.d_b + r * d, g.p[k] + row_of(rows.p_index[k], first + r) * d);
        for (int k = 0; k < w.inputs; ++k) {
            const int n = w.in[k];
            const float* x =
                rows.x_index[k] ? tile.x[k] : rows.x[k] + static_cast<size_t>(first) * n;
            if (g.w1[k])
                kernels::multiply_transposed<Block>(count, d, n, tile.d_b, d, x, n, g.w1[k], n);
            if (!g.x[k]) continue;
            if (!rows.x_index[k]) {
                kernels::multiply<Block>(count, d, n, tile.d_b, d, w.w1[k], n,
                                         g.x[k] + static_cast<size_t>(first) * n, n);
                continue;
            }
            std::memset(tile.x[k], 0, sizeof(float) * count * n);
            kernels::multiply<Block>(count, d, n, tile.d_b, d, w.w1[k], n, tile.x[k], n);
            for (int r = 0; r < count; ++r)
                add_row(n, tile.x[k] + r * n, g.x[k] + row_of(rows.x_index[k], first + r) * n);
        }
    }
}

template <int Block>
CLOTH_INLINE void dense(int rows, int in, int out, const float* x, const float* weight,
                        const float* bias, bool with_relu, float* y, MessageBlockScratch& scratch) {
    const size_t needed = static_cast<size_t>(in) * static_cast<size_t>(out);
    if (scratch.size() < needed) scratch.resize(needed);
    transpose(weight, out, in, scratch.data());
    if (bias)
        fill_rows(rows, out, bias, y);
    else
        std::memset(y, 0, sizeof(float) * static_cast<size_t>(rows) * static_cast<size_t>(out));
    kernels::multiply<Block>(rows, in, out, x, in, scratch.data(), out, y, out);
    if (with_relu) relu(rows * out, y);
}

#if defined(__x86_64__)
#define CLOTH_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))

CLOTH_AVX512 void forward_avx512(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                 float* out, float* sum, MessageBlockScratch& scratch) {
    forward<8>(w, rows, out, sum, scratch);
}

CLOTH_AVX512 void backward_avx512(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                  const float* d_out, const float* d_sum,
                                  const MessageBlockGradients& g, MessageBlockScratch& scratch) {
    backward<8>(w, rows, d_out, d_sum, g, scratch);
}

CLOTH_AVX512 void dense_avx512(int rows, int in, int out, const float* x, const float* weight,
                               const float* bias, bool with_relu, float* y,
                               MessageBlockScratch& scratch) {
    dense<8>(rows, in, out, x, weight, bias, with_relu, y, scratch);
}

bool has_avx512() {
    static const bool found =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    return found;
}
#endif

}  // namespace

void message_block_forward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                           float* out, float* sum, MessageBlockScratch& scratch) {
#if defined(__x86_64__)
    if (has_avx512()) return forward_avx512(weights, rows, out, sum, scratch);
#endif
    forward<4>(weights, rows, out, sum, scratch);
}

void message_block_backward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                            const float* d_out, const float* d_sum,
                            const MessageBlockGradients& gradients, MessageBlockScratch& scratch) {
#if defined(__x86_64__)
    if (has_avx512()) return backward_avx512(weights, rows, d_out, d_sum, gradients, scratch);
#endif
    backward<4>(weights, rows, d_out, d_sum, gradients, scratch);
}

void dense_layer(int rows, int in, int out, const float* x, const float* weight, const float* bias,
                 bool with_relu, float* y, MessageBlockScratch& scratch) {
#if defined(__x86_64__)
    if (has_avx512()) return dense_avx512(rows, in, out, x, weight, bias, with_relu, y, scratch);
#endif
    dense<4>(rows, in, out, x, weight, bias, with_relu, y, scratch);
}

void message_block_forward_plain(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                 float* out, float* sum) {
    const size_t d = static_cast<size_t>(w.width);
    std::vector<float> h1(d), h2(d), y(d);
    const auto layer = [d](const float* weight, size_t in, const float* x, std::vector<float>& to) {
        for (size_t o = 0; o < d; ++o)
            for (size_t i = 0; i < in; ++i) to[o] += weight[o * in + i] * x[i];
    };
    const auto cut = [](std::vector<float>& x) {
        for (float& value : x) value = std::max(value, 0.0f);
    };
    for (int r = 0; r < rows.rows; ++r) {
        h1.assign(w.b1, w.b1 + d);
        for (int k = 0; k < w.inputs; ++k)
            layer(w.w1[k], static_cast<size_t>(w.in[k]),
                  rows.x[k] + row_of(rows.x_index[k], r) * static_cast<size_t>(w.in[k]), h1);
        for (int k = 0; k < rows.products; ++k)
            for (size_t o = 0; o < d; ++o) h1[o] += rows.p[k][row_of(rows.p_index[k], r) * d + o];
        cut(h1);
        h2.assign(w.b2, w.b2 + d);
        layer(w.w2, d, h1.data(), h2);
        cut(h2);
        y.assign(w.b3, w.b3 + d);
        layer(w.w3, d, h2.data(), y);
        float mean = 0.0f, variance = 0.0f;
        for (float value : y) mean += value / static_cast<float>(d);
        for (float value : y) variance += (value - mean) * (value - mean) / static_cast<float>(d);
        const float inverse = 1.0f / std::sqrt(variance + norm_epsilon);
        for (size_t o = 0; o < d; ++o) {
            const float message = (y[o] - mean) * inverse * w.gamma[o] + w.beta[o];
            const size_t edge = row_of(rows.x_index[0], r) * d + o;
            if (out) out[edge] = rows.x[0][edge] + message;
            if (sum) sum[row_of(rows.sum_index, r) * d + o] += rows.sum_scale * message;
        }
    }
}

}  // namespace cloth
