#include "gnn/model/message_block.h"

#include <algorithm>
#include <cmath>

#include "gnn/model/message_kernels.h"

namespace cloth {

namespace {

const MessageKernels& kernels_for(Instructions instructions) {
#if defined(__x86_64__)
    if (instructions == Instructions::avx512_bf16) return avx512_bf16_kernels;
    if (instructions == Instructions::avx512) return avx512_kernels;
    if (instructions == Instructions::avx2) return avx2_kernels;
#endif
    (void)instructions;
    return portable_kernels;
}

/// Tile buffers of the kernels (see Tile there).
size_t tile_floats(const MessageBlockWeights& w) {
    size_t inputs = 0;
    for (int k = 0; k < w.inputs; ++k) inputs += static_cast<size_t>(w.in[k]);
    return tile_rows * (6 * static_cast<size_t>(w.width) + 2 + inputs);
}

/// Scratch for the kernels; packs the weights into it if they are not.
float* prepare(MessageBlockWeights& w, MessageBlockScratch& scratch) {
    const size_t panels = w.panels ? 0 : block_panel_count(w), tile = tile_floats(w);
    if (scratch.size() < panels + tile) scratch.resize(panels + tile);
    if (!w.panels) {
        pack_block(w, scratch.data() + tile);
        w.panels = scratch.data() + tile;
    }
    return scratch.data();
}

}  // namespace

bool is_supported(Instructions instructions) {
#if defined(__x86_64__)
    if (instructions == Instructions::avx512_bf16)
        return __builtin_cpu_supports("avx512bf16") && is_supported(Instructions::avx512);
    if (instructions == Instructions::avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    if (instructions == Instructions::avx2)
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
    return instructions == Instructions::portable;
}

Instructions best_instructions() {
    static const Instructions best = [] {
        for (const Instructions one :
             {Instructions::avx512_bf16, Instructions::avx512, Instructions::avx2})
            if (is_supported(one)) return one;
        return Instructions::portable;
    }();
    return best;
}

void pack_panels(const float* weight, int out, int in, float* panels) {
    for (int first = 0; first < out; first += panel_width) {
        const int width = std::min(panel_width, out - first);
        for (int i = 0; i < in; ++i)
            for (int o = 0; o < width; ++o) *panels++ = weight[(first + o) * in + i];
    }
}

void pack_panels(const float* weight, int out, int in, Bfloat16* panels) {
    for (int first = 0; first < out; first += panel_width) {
        const int width = std::min(panel_width, out - first);
        for (int i = 0; i < in; i += 2)
            for (int o = 0; o < width; ++o)
                for (int k = 0; k < 2; ++k)
                    *panels++ = to_bfloat16(weight[(first + o) * in + i + k]);
    }
}

size_t block_panel_count(const MessageBlockWeights& w) {
    const size_t d = static_cast<size_t>(w.width);
    size_t count = 2 * d * d;
    for (int k = 0; k < w.inputs; ++k) count += d * static_cast<size_t>(w.in[k]);
    return count;
}

template <typename Number>
static Number* pack_first_and_second(const MessageBlockWeights& w, Number* panels) {
    for (int k = 0; k < w.inputs; ++k) {
        pack_panels(w.w1[k], w.width, w.in[k], panels);
        panels += w.width * w.in[k];
    }
    pack_panels(w.w2, w.width, w.width, panels);
    return panels + w.width * w.width;
}

void pack_block(const MessageBlockWeights& w, float* panels) {
    pack_panels(w.w3, w.width, w.width, pack_first_and_second(w, panels));
}

void pack_block(const MessageBlockWeights& w, Bfloat16* panels) {
    const size_t d = static_cast<size_t>(w.width);
    std::vector<float> centred(w.w3, w.w3 + d * d);
    for (size_t i = 0; i < d; ++i) {
        double mean = 0.0;
        for (size_t o = 0; o < d; ++o) mean += static_cast<double>(w.w3[o * d + i]);
        for (size_t o = 0; o < d; ++o)
            centred[o * d + i] -= static_cast<float>(mean / static_cast<double>(d));
    }
    pack_panels(centred.data(), w.width, w.width, pack_first_and_second(w, panels));
}

void message_block_forward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                           float* out, float* sum, MessageBlockScratch& scratch,
                           Instructions instructions) {
    MessageBlockWeights packed = weights;
    float* buffers = prepare(packed, scratch);
    const MessageKernels& kernels = kernels_for(instructions);
    (packed.panels.bfloat16 ? kernels.forward_bf16 : kernels.forward)(packed, rows, out, sum,
                                                                      buffers);
}

void message_block_backward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                            const float* d_out, const float* d_sum,
                            const MessageBlockGradients& gradients, MessageBlockScratch& scratch,
                            Instructions instructions) {
    MessageBlockWeights packed = weights;
    float* buffers = prepare(packed, scratch);
    kernels_for(instructions).backward(packed, rows, d_out, d_sum, gradients, buffers);
}

void dense_layer(int rows, int in, int out, const float* x, Panels panels, const float* bias,
                 bool with_relu, float* y, MessageBlockScratch& scratch,
                 Instructions instructions) {
    const MessageKernels& kernels = kernels_for(instructions);
    if (panels.float32) {
        kernels.dense(rows, in, out, x, panels.float32, bias, with_relu, y);
        return;
    }
    const size_t tile = static_cast<size_t>(tile_rows / 2 * in);
    if (scratch.size() < tile) scratch.resize(tile);
    kernels.dense_bf16(rows, in, out, x, panels.bfloat16, bias, with_relu, y, scratch.data());
}

static size_t row_of(const int* index, int r) {
    return static_cast<size_t>(index ? index[r] : r);
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
            if (rows.x[k])
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
        const float inverse = 1.0f / std::sqrt(variance + 1e-5f);
        for (size_t o = 0; o < d; ++o) {
            const float message = (y[o] - mean) * inverse * w.gamma[o] + w.beta[o];
            const size_t edge = row_of(rows.x_index[0], r) * d + o;
            if (out) out[edge] = rows.x[0][edge] + message;
            if (sum) sum[row_of(rows.sum_index, r) * d + o] += rows.sum_scale * message;
        }
    }
}

}  // namespace cloth
