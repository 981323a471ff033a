// The loops of a message block, written with GCC's vector extension and compiled once per
// instruction set: message_kernels_*.cpp include this text, define CLOTH_KERNELS and are given
// their own -m options. Everything is internal to the file and free of the standard library, so
// that no function compiled for a newer processor can be picked by the linker for an older one.
//
// BLOCK x COLUMNS registers hold sums: 8 x 2 fill 16 of the 32 registers of AVX-512 and need 10
// loads for 16 multiply-adds, 6 x 2 fill 12 of the 16 of AVX2, 4 x 2 half of the 16 of SSE. A
// vector is one register: GCC moves arrays of wider ones through memory, at a tenth of the speed.

#if defined(__AVX512BF16__) || (defined(__AVX2__) && !defined(__AVX512F__))
#include <immintrin.h>
#endif

#include "gnn/model/message_kernels.h"

namespace cloth {
namespace {

#define CLOTH_INLINE inline __attribute__((always_inline))

#if defined(__AVX512F__)
constexpr int lanes = 16, block = 8, columns = 2;
#elif defined(__AVX2__)
constexpr int lanes = 8, block = 6, columns = 2;
#else
constexpr int lanes = 4, block = 4, columns = 2;
#endif
typedef float Lanes __attribute__((vector_size(4 * lanes)));
/// Lanes in memory: clang forgets that arrays of them, as local variables, are aligned so little.
typedef float LanesInMemory __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
static_assert(kernel_lanes % lanes == 0, "a row is whole vectors");

constexpr float norm_epsilon = 1e-5f;  // as LibTorch's LayerNorm
static_assert(tile_rows % lanes == 0 && tile_rows % block == 0, "tiles are whole blocks");

CLOTH_INLINE Lanes load(const float* p) {
    return *reinterpret_cast<const LanesInMemory*>(p);
}
CLOTH_INLINE LanesInMemory& at(float* p) {
    return *reinterpret_cast<LanesInMemory*>(p);
}
CLOTH_INLINE int smaller(int a, int b) {
    return a < b ? a : b;
}
CLOTH_INLINE long row_of(const int* index, int r) {
    return index ? index[r] : r;
}

/// One input of a layer: rows of numbers and the panels that they are multiplied with.
struct Input {
    const float* x;
    const int* index;  // of the tile's rows, or null
    int width;
    const float* panels;
};

/// A layer over the rows of a tile: y = [relu](sum_k W_k x_k + sum_k p_k + b).
struct Layer {
    Input input[MessageBlockWeights::max_inputs];
    int inputs;
    int outputs;
    const float* bias;  // or null
    const float* p[2];
    const int* p_index[2];
    int products;
    bool with_relu;
};

template <int Block, int Columns>
CLOTH_INLINE void multiply_add(int k, const float* const (&a)[Block], const float* b, int ldb,
                               Lanes (&sum)[Block][Columns]) {
    for (int i = 0; i < k; ++i) {
        Lanes row[Columns];
        for (int j = 0; j < Columns; ++j) row[j] = load(b + i * ldb + j * lanes);
        for (int r = 0; r < Block; ++r) {
            const float value = a[r][i];
            for (int j = 0; j < Columns; ++j) sum[r][j] += value * row[j];
        }
    }
}

/// Outputs [column, column + lanes Columns) of rows [first, first + Block).
template <int Block, int Columns>
CLOTH_INLINE void layer_block(const Layer& layer, int first, int column, float* y) {
    const int d = layer.outputs;
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j)
            sum[r][j] = layer.bias ? load(layer.bias + column + j * lanes) : Lanes{};
    for (int k = 0; k < layer.products; ++k)
        for (int r = 0; r < Block; ++r) {
            const float* p = layer.p[k] + row_of(layer.p_index[k], first + r) * d + column;
            for (int j = 0; j < Columns; ++j) sum[r][j] += load(p + j * lanes);
        }
    const int panel = column / panel_width * panel_width;
    const int ldb = smaller(panel_width, d - panel);
    for (int k = 0; k < layer.inputs; ++k) {
        const Input& input = layer.input[k];
        const float* a[Block];
        for (int r = 0; r < Block; ++r)
            a[r] = input.x + row_of(input.index, first + r) * input.width;
        multiply_add<Block, Columns>(input.width, a,
                                     input.panels + panel * input.width + column - panel, ldb, sum);
    }
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) {
            const Lanes value = sum[r][j];
            at(y + static_cast<long>(first + r) * d + column + j * lanes) =
                layer.with_relu ? (value > 0.0f ? value : Lanes{}) : value;
        }
}

template <int Columns>
CLOTH_INLINE void layer_column(const Layer& layer, int rows, int column, float* y) {
    int r = 0;
    for (; r + block <= rows; r += block) layer_block<block, Columns>(layer, r, column, y);
    for (; r < rows; ++r) layer_block<1, Columns>(layer, r, column, y);
}

inline void evaluate(const Layer& layer, int rows, float* y) {
    int column = 0;
    for (; column + lanes * columns <= layer.outputs; column += lanes * columns)
        layer_column<columns>(layer, rows, column, y);
    for (; column < layer.outputs; column += lanes) layer_column<1>(layer, rows, column, y);
}

#if defined(__AVX512F__)
typedef int Mask __attribute__((vector_size(64)));

CLOTH_INLINE Lanes shuffle(Lanes a, Lanes b, Mask from) {
#if defined(__clang__)  // has no such function for a mask that is a value
    Lanes result = {};
    for (int k = 0; k < lanes; ++k) result[k] = from[k] < lanes ? a[from[k]] : b[from[k] - lanes];
    return result;
#else
    return __builtin_shuffle(a, b, from);
#endif
}

CLOTH_INLINE Lanes shuffled_sum(Lanes a, Lanes b, Mask first, Mask second) {
    return shuffle(a, b, first) + shuffle(a, b, second);
}
#endif

/// Sums of as many vectors as one has lanes, one per lane. Every vector is summed in the same order
/// of its lanes.
CLOTH_INLINE Lanes sums_of(const Lanes (&t)[lanes]) {
#if defined(__AVX512F__)
    // Within quarters of a vector: pairs of vectors, then pairs of pairs, one instruction each.
    constexpr Mask low = {0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29};
    constexpr Mask high = {2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31};
    constexpr Mask low_pairs = {0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29};
    constexpr Mask high_pairs = {2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31};
    Lanes pair[8], quad[4];
    for (int i = 0; i < 8; ++i) pair[i] = shuffled_sum(t[2 * i], t[2 * i + 1], low, high);
    for (int i = 0; i < 4; ++i)
        quad[i] = shuffled_sum(pair[2 * i], pair[2 * i + 1], low_pairs, high_pairs);
    // Each quarter of quad[i] now holds partial sums of vectors 4i to 4i + 3.
    constexpr Mask even = {0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27};
    constexpr Mask odd = {4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31};
    return shuffled_sum(shuffled_sum(quad[0], quad[1], even, odd),
                        shuffled_sum(quad[2], quad[3], even, odd), even, odd);
#elif defined(__AVX2__)
    const __m256 a = _mm256_hadd_ps(_mm256_hadd_ps(t[0], t[1]), _mm256_hadd_ps(t[2], t[3]));
    const __m256 b = _mm256_hadd_ps(_mm256_hadd_ps(t[4], t[5]), _mm256_hadd_ps(t[6], t[7]));
    return _mm256_add_ps(_mm256_permute2f128_ps(a, b, 0x20), _mm256_permute2f128_ps(a, b, 0x31));
#else
    Lanes result{};
    for (int r = 0; r < lanes; ++r) {
        float sum = 0.0f;
        for (int i = 0; i < lanes; ++i) sum += t[r][i];
        result[r] = sum;
    }
    return result;
#endif
}

/// Mean and 1 / deviation of as many rows as there are lanes.
CLOTH_INLINE void norm_statistics(int d, const float* y, float* mean, float* inverse) {
    const float share = 1.0f / static_cast<float>(d);
    Lanes t[lanes];
    for (int r = 0; r < lanes; ++r) {
        t[r] = load(y + r * d);
        for (int i = lanes; i < d; i += lanes) t[r] += load(y + r * d + i);
    }
    at(mean) = sums_of(t) * share;
    for (int r = 0; r < lanes; ++r) {
        const float centre = mean[r];
        t[r] = Lanes{};
        for (int i = 0; i < d; i += lanes) {
            const Lanes offset = load(y + r * d + i) - centre;
            t[r] += offset * offset;
        }
    }
    const Lanes variance = sums_of(t) * share + norm_epsilon;
    for (int r = 0; r < lanes; ++r) inverse[r] = 1.0f / __builtin_sqrtf(variance[r]);
}

/// Buffers of one tile, cut from the caller's scratch: see scratch_floats().
struct Tile {
    float *a, *b, *y;       // (tile x D): activations; y is the third layer's output
    float *mean, *inverse;  // (tile)
    float *c, *e, *normed;  // (tile x D), backward only
    float* x[MessageBlockWeights::max_inputs];  // gathered inputs, backward only
};

CLOTH_INLINE Tile make_tile(const MessageBlockWeights& w, float* scratch) {
    const int d = w.width;
    Tile tile{};
    for (float** buffer : {&tile.a, &tile.b, &tile.y, &tile.c, &tile.e, &tile.normed}) {
        *buffer = scratch;
        scratch += tile_rows * d;
    }
    tile.mean = scratch;
    tile.inverse = scratch + tile_rows;
    scratch += 2 * tile_rows;
    for (int k = 0; k < w.inputs; ++k) {
        tile.x[k] = scratch;
        scratch += tile_rows * w.in[k];
    }
    return tile;
}

/// Activations a (first layer), b (second) and y of rows [first, first + count), and y's
/// statistics.
CLOTH_INLINE void evaluate_tile(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                int first, int count, const Tile& tile) {
    const int d = w.width;
    const float* panels = w.panels.float32;
    Layer layer{};
    layer.outputs = d;
    layer.bias = w.b1;
    layer.with_relu = true;
    for (int k = 0; k < w.inputs; ++k) {
        const int n = w.in[k];
        const int* index = rows.x_index[k] ? rows.x_index[k] + first : nullptr;
        if (rows.x[k])
            layer.input[layer.inputs++] = {
                index ? rows.x[k] : rows.x[k] + static_cast<long>(first) * n, index, n, panels};
        panels += static_cast<long>(n) * d;
    }
    layer.products = rows.products;
    for (int k = 0; k < rows.products; ++k) {
        layer.p_index[k] = rows.p_index[k] ? rows.p_index[k] + first : nullptr;
        layer.p[k] = layer.p_index[k] ? rows.p[k] : rows.p[k] + static_cast<long>(first) * d;
    }
    evaluate(layer, count, tile.a);
    Layer second{};
    second.inputs = 1;
    second.outputs = d;
    second.input[0] = {tile.a, nullptr, d, panels};
    second.bias = w.b2;
    second.with_relu = true;
    evaluate(second, count, tile.b);
    Layer third = second;
    third.input[0] = {tile.b, nullptr, d, panels + static_cast<long>(d) * d};
    third.bias = w.b3;
    third.with_relu = false;
    evaluate(third, count, tile.y);
    for (int r = 0; r < count; r += lanes)
        norm_statistics(d, tile.y + r * d, tile.mean + r, tile.inverse + r);
}

void forward(const MessageBlockWeights& w, const MessageBlockRows& rows, float* out, float* sum,
             float* scratch) {
    const Tile tile = make_tile(w, scratch);
    const int d = w.width;
    for (int first = 0; first < rows.rows; first += tile_rows) {
        const int count = smaller(tile_rows, rows.rows - first);
        evaluate_tile(w, rows, first, count, tile);
        for (int r = 0; r < count; ++r) {
            const long edge = row_of(rows.x_index[0], first + r) * d;
            float* sum_row = sum ? sum + row_of(rows.sum_index, first + r) * d : nullptr;
            const float mean = tile.mean[r], inverse = tile.inverse[r];
            for (int i = 0; i < d; i += lanes) {
                const Lanes message =
                    (load(tile.y + r * d + i) - mean) * inverse * load(w.gamma + i) +
                    load(w.beta + i);
                if (out) at(out + edge + i) = load(rows.x[0] + edge + i) + message;
                if (sum) at(sum_row + i) += rows.sum_scale * message;
            }
        }
    }
}

void dense(int rows, int in, int out, const float* x, const float* panels, const float* bias,
           bool with_relu, float* y) {
    Layer layer{};
    layer.inputs = 1;
    layer.outputs = out;
    layer.input[0] = {x, nullptr, in, panels};
    layer.bias = bias;
    layer.with_relu = with_relu;
    evaluate(layer, rows, y);
}

CLOTH_INLINE void add_row(int n, const float* from, float* to) {
    for (int i = 0; i < n; i += lanes) at(to + i) += load(from + i);
}

CLOTH_INLINE void add_columns(int rows, int n, const float* x, float* sum) {
    if (!sum) return;
    for (int r = 0; r < rows; ++r) add_row(n, x + r * n, sum);
}

/// Zeroes the gradient where the activation was cut off.
CLOTH_INLINE void relu_backward(int count, const float* activation, float* gradient) {
    for (int i = 0; i < count; i += lanes) {
        const Lanes value = load(activation + i);
        at(gradient + i) = value > 0.0f ? load(gradient + i) : Lanes{};
    }
}

/// C (Block rows, leading ldc) = A (leading lda) B (k x *, leading ldb), lanes Columns outputs.
template <int Block, int Columns>
CLOTH_INLINE void product_block(int k, const float* a, int lda, const float* b, int ldb, float* c,
                                int ldc) {
    const float* rows[Block];
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r) {
        rows[r] = a + r * lda;
        for (int j = 0; j < Columns; ++j) sum[r][j] = Lanes{};
    }
    multiply_add<Block, Columns>(k, rows, b, ldb, sum);
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) at(c + r * ldc + j * lanes) = sum[r][j];
}

/// C (rows x n) = A (rows x k) B (k x n).
inline void product(int rows, int k, int n, const float* a, const float* b, float* c) {
    int j = 0;
    for (; j + lanes * columns <= n; j += lanes * columns) {
        int r = 0;
        for (; r + block <= rows; r += block)
            product_block<block, columns>(k, a + r * k, k, b + j, n, c + r * n + j, n);
        for (; r < rows; ++r)
            product_block<1, columns>(k, a + r * k, k, b + j, n, c + r * n + j, n);
    }
    for (; j < n; j += lanes) {
        int r = 0;
        for (; r + block <= rows; r += block)
            product_block<block, 1>(k, a + r * k, k, b + j, n, c + r * n + j, n);
        for (; r < rows; ++r) product_block<1, 1>(k, a + r * k, k, b + j, n, c + r * n + j, n);
    }
}

/// C (Block rows of m, leading n) += A' B, with A (rows x m), B (rows x n).
template <int Block, int Columns>
CLOTH_INLINE void transposed_block(int rows, const float* a, int m, const float* b, int n,
                                   float* c) {
    Lanes sum[Block][Columns];
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) sum[r][j] = load(c + r * n + j * lanes);
    for (int t = 0; t < rows; ++t) {
        Lanes row[Columns];
        for (int j = 0; j < Columns; ++j) row[j] = load(b + t * n + j * lanes);
        for (int r = 0; r < Block; ++r) {
            const float value = a[t * m + r];
            for (int j = 0; j < Columns; ++j) sum[r][j] += value * row[j];
        }
    }
    for (int r = 0; r < Block; ++r)
        for (int j = 0; j < Columns; ++j) at(c + r * n + j * lanes) = sum[r][j];
}

/// C (m x n) += A' B with A (rows x m), B (rows x n).
inline void add_transposed_product(int rows, int m, int n, const float* a, const float* b,
                                   float* c) {
    constexpr int width = lanes * columns;
    for (int j = 0; j < n;) {
        const bool wide = j + width <= n;
        int i = 0;
        for (; i + block <= m; i += block)
            wide ? transposed_block<block, columns>(rows, a + i, m, b + j, n, c + i * n + j)
                 : transposed_block<block, 1>(rows, a + i, m, b + j, n, c + i * n + j);
        for (; i < m; ++i)
            wide ? transposed_block<1, columns>(rows, a + i, m, b + j, n, c + i * n + j)
                 : transposed_block<1, 1>(rows, a + i, m, b + j, n, c + i * n + j);
        j += wide ? width : lanes;
    }
}

CLOTH_INLINE float lane_sum(const Lanes& values) {
    float sum = 0.0f;
    for (int i = 0; i < lanes; ++i) sum += values[i];
    return sum;
}

/// Gradient of the message (tile.c), through the LayerNorm, to that of y (tile.e).
inline void norm_backward(const MessageBlockWeights& w, const MessageBlockGradients& g, int count,
                          const Tile& tile) {
    const int d = w.width;
    for (int r = 0; r < count; ++r) {
        float* message = tile.c + r * d;
        float* normed = tile.normed + r * d;
        Lanes mean{}, slope{};
        for (int i = 0; i < d; i += lanes) {
            at(normed + i) = (load(tile.y + r * d + i) - tile.mean[r]) * tile.inverse[r];
            if (g.gamma) at(g.gamma + i) += load(message + i) * load(normed + i);
            if (g.beta) at(g.beta + i) += load(message + i);
            at(message + i) *= load(w.gamma + i);
            mean += load(message + i);
            slope += load(message + i) * load(normed + i);
        }
        const float share = 1.0f / static_cast<float>(d);
        const float offset = share * lane_sum(mean), tilt = share * lane_sum(slope);
        for (int i = 0; i < d; i += lanes)
            at(tile.e + r * d + i) =
                tile.inverse[r] * (load(message + i) - offset - tilt * load(normed + i));
    }
}

/// Gradient of the messages of a tile: of the residual output and of the receivers' sums.
inline void gather_gradient(const MessageBlockRows& rows, int first, int count, int d,
                            const float* d_out, const float* d_sum, float* to) {
    for (int r = 0; r < count; ++r) {
        const float* edge = d_out ? d_out + row_of(rows.x_index[0], first + r) * d : nullptr;
        const float* receiver = d_sum ? d_sum + row_of(rows.sum_index, first + r) * d : nullptr;
        for (int i = 0; i < d; i += lanes) {
            Lanes message{};
            if (edge) message += load(edge + i);
            if (receiver) message += rows.sum_scale * load(receiver + i);
            at(to + r * d + i) = message;
        }
    }
}

/// Gradients of the first layer's inputs, products and weights from that of its sum (tile.e).
inline void first_layer_backward(const MessageBlockWeights& w, const MessageBlockRows& rows,
                                 const MessageBlockGradients& g, int first, int count,
                                 const Tile& tile) {
    const int d = w.width;
    add_columns(count, d, tile.e, g.b1);
    for (int k = 0; k < rows.products; ++k)
        if (g.p[k])
            for (int r = 0; r < count; ++r)
                add_row(d, tile.e + r * d, g.p[k] + row_of(rows.p_index[k], first + r) * d);
    for (int k = 0; k < w.inputs; ++k) {
        const int n = w.in[k];
        const int* index = rows.x_index[k] ? rows.x_index[k] + first : nullptr;
        const float* x = rows.x[k] + (index ? 0 : static_cast<long>(first) * n);
        if (index) {
            for (int r = 0; r < count; ++r)
                __builtin_memcpy(tile.x[k] + r * n, x + static_cast<long>(index[r]) * n,
                                 sizeof(float) * static_cast<unsigned>(n));
            x = tile.x[k];
        }
        if (g.w1[k]) add_transposed_product(count, d, n, tile.e, x, g.w1[k]);
        if (!g.x[k]) continue;
        product(count, d, n, tile.e, w.w1[k], tile.x[k]);
        for (int r = 0; r < count; ++r)
            add_row(n, tile.x[k] + r * n, g.x[k] + row_of(rows.x_index[k], first + r) * n);
    }
}

void backward(const MessageBlockWeights& w, const MessageBlockRows& rows, const float* d_out,
              const float* d_sum, const MessageBlockGradients& g, float* scratch) {
    const Tile tile = make_tile(w, scratch);
    const int d = w.width;
    for (int first = 0; first < rows.rows; first += tile_rows) {
        const int count = smaller(tile_rows, rows.rows - first);
        evaluate_tile(w, rows, first, count, tile);
        gather_gradient(rows, first, count, d, d_out, d_sum, tile.c);
        norm_backward(w, g, count, tile);
        // third layer: e is the gradient of y
        add_columns(count, d, tile.e, g.b3);
        if (g.w3) add_transposed_product(count, d, d, tile.e, tile.b, g.w3);
        product(count, d, d, tile.e, w.w3, tile.c);
        relu_backward(count * d, tile.b, tile.c);
        // second layer: c is the gradient of its pre-activation
        add_columns(count, d, tile.c, g.b2);
        if (g.w2) add_transposed_product(count, d, d, tile.c, tile.a, g.w2);
        product(count, d, d, tile.c, w.w2, tile.e);
        relu_backward(count * d, tile.a, tile.e);
        first_layer_backward(w, rows, g, first, count, tile);
    }
}

#include "gnn/model/message_kernels_bf16.inl"

}  // namespace

extern const MessageKernels CLOTH_KERNELS;
const MessageKernels CLOTH_KERNELS = {forward, backward, dense, forward_bf16, dense_bf16};

}  // namespace cloth
