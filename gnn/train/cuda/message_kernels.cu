#include <cuda_runtime.h>

#include "gnn/train/cuda/message_kernels.h"

namespace cloth::cuda {

namespace {

constexpr int lanes = 32;         // of a warp, which takes a row at a time
constexpr int warps = 8;          // of a block
constexpr int most_columns = 16;  // per lane: widths to 512

/// Enough blocks to fill any GPU, few enough that sums over rows end in few additions.
int blocks_for(std::int64_t rows) {
    const std::int64_t wanted = (rows + warps - 1) / warps;
    return static_cast<int>(wanted < 2048 ? wanted : 2048);
}

__device__ std::int64_t first_row() {
    return static_cast<std::int64_t>(blockIdx.x) * warps + threadIdx.y;
}

__device__ std::int64_t row_step() {
    return static_cast<std::int64_t>(gridDim.x) * warps;
}

__device__ std::int64_t row_of(const std::int64_t* index, std::int64_t r) {
    return index ? index[r] : r;
}

__device__ float sum_of_warp(float value) {
    for (int step = lanes / 2; step > 0; step /= 2)
        value += __shfl_xor_sync(0xffffffffu, value, step);
    return value;
}

/// Adds the columns' sums of a block's warps to `to`; each thread holds those of its own rows.
template <int columns>
__device__ void add_columns(const float (&sums)[columns], int width, float* to) {
    __shared__ float shared[warps][lanes];
    for (int c = 0; c < columns; ++c) {
        shared[threadIdx.y][threadIdx.x] = sums[c];
        __syncthreads();
        const int column = c * lanes + threadIdx.x;
        if (threadIdx.y == 0 && column < width) {
            float all = 0.0f;
            for (int w = 0; w < warps; ++w) all += shared[w][threadIdx.x];
            atomicAdd(to + column, all);
        }
        __syncthreads();
    }
}

__global__ void first_layer_kernel(FirstLayer layer, float* h) {
    for (std::int64_t r = first_row(); r < layer.rows; r += row_step()) {
        const std::int64_t x = row_of(layer.x_index, r) * layer.width;
        const std::int64_t p0 = row_of(layer.p_index[0], r) * layer.width;
        const std::int64_t p1 = row_of(layer.p_index[1], r) * layer.width;
        for (int c = threadIdx.x; c < layer.width; c += lanes) {
            float value = layer.bias[c] + layer.x[x + c];
            if (layer.rest) value += layer.rest[r * layer.width + c];
            if (layer.p[0]) value += layer.p[0][p0 + c];
            if (layer.p[1]) value += layer.p[1][p1 + c];
            h[r * layer.width + c] = fmaxf(value, 0.0f);
        }
    }
}

template <int columns>
__global__ void first_layer_backward_kernel(FirstLayer layer, const float* h, float* g, float* dx,
                                            float* dp0, float* dp1, float* d_bias) {
    float sums[columns] = {};
    for (std::int64_t r = first_row(); r < layer.rows; r += row_step()) {
        const std::int64_t x = row_of(layer.x_index, r) * layer.width;
        const std::int64_t p0 = row_of(layer.p_index[0], r) * layer.width;
        const std::int64_t p1 = row_of(layer.p_index[1], r) * layer.width;
        for (int c = 0; c < columns; ++c) {
            const int column = c * lanes + threadIdx.x;
            if (column >= layer.width) break;
            const std::int64_t at = r * layer.width + column;
            const float value = h[at] > 0.0f ? g[at] : 0.0f;
            g[at] = value;
            sums[c] += value;
            if (dx && layer.x_index) atomicAdd(dx + x + column, value);
            if (dp0 && layer.p_index[0]) atomicAdd(dp0 + p0 + column, value);
            if (dp1 && layer.p_index[1]) atomicAdd(dp1 + p1 + column, value);
        }
    }
    add_columns(sums, layer.width, d_bias);
}

template <int columns>
__global__ void relu_backward_kernel(std::int64_t rows, int width, const float* h, float* g,
                                     float* d_bias) {
    float sums[columns] = {};
    for (std::int64_t r = first_row(); r < rows; r += row_step())
        for (int c = 0; c < columns; ++c) {
            const int column = c * lanes + threadIdx.x;
            if (column >= width) break;
            const std::int64_t at = r * width + column;
            const float value = h[at] > 0.0f ? g[at] : 0.0f;
            g[at] = value;
            sums[c] += value;
        }
    add_columns(sums, width, d_bias);
}

/// A row, normalised; returns 1 / deviation.
template <int columns>
__device__ float normalise(const float* row, int width, float (&values)[columns]) {
    float sum = 0.0f;
    for (int c = 0; c < columns; ++c) {
        const int column = c * lanes + threadIdx.x;
        values[c] = column < width ? row[column] : 0.0f;
        sum += values[c];
    }
    const float mean = sum_of_warp(sum) / static_cast<float>(width);
    float squares = 0.0f;
    for (int c = 0; c < columns; ++c) {
        values[c] = c * lanes + threadIdx.x < width ? values[c] - mean : 0.0f;
        squares += values[c] * values[c];
    }
    const float scale = rsqrtf(sum_of_warp(squares) / static_cast<float>(width) + 1e-5f);
    for (int c = 0; c < columns; ++c) values[c] *= scale;
    return scale;
}

template <int columns>
__global__ void norm_and_add_kernel(Norm norm, float* out, float* sum) {
    for (std::int64_t r = first_row(); r < norm.rows; r += row_step()) {
        float values[columns];
        normalise(norm.h + r * norm.width, norm.width, values);
        const std::int64_t x = row_of(norm.x_index, r) * norm.width;
        const std::int64_t s = row_of(norm.sum_index, r) * norm.width;
        for (int c = 0; c < columns; ++c) {
            const int column = c * lanes + threadIdx.x;
            if (column >= norm.width) break;
            const float message = values[c] * norm.gamma[column] + norm.beta[column];
            if (out) atomicAdd(out + x + column, message);
            if (sum) atomicAdd(sum + s + column, norm.sum_scale * message);
        }
    }
}

template <int columns>
__global__ void norm_backward_kernel(Norm norm, const float* d_out, const float* d_sum, float* dh,
                                     float* d_gamma, float* d_beta, float* d_bias) {
    float gammas[columns] = {}, betas[columns] = {}, biases[columns] = {};
    const float inverse = 1.0f / static_cast<float>(norm.width);
    for (std::int64_t r = first_row(); r < norm.rows; r += row_step()) {
        float values[columns], d[columns];
        const float scale = normalise(norm.h + r * norm.width, norm.width, values);
        const std::int64_t x = row_of(norm.x_index, r) * norm.width;
        const std::int64_t s = row_of(norm.sum_index, r) * norm.width;
        float sum = 0.0f, product = 0.0f;
        for (int c = 0; c < columns; ++c) {
            const int column = c * lanes + threadIdx.x;
            d[c] = 0.0f;
            if (column >= norm.width) continue;
            float message = d_out ? d_out[x + column] : 0.0f;
            if (d_sum) message += norm.sum_scale * d_sum[s + column];
            gammas[c] += message * values[c];
            betas[c] += message;
            d[c] = message * norm.gamma[column];
            sum += d[c];
            product += d[c] * values[c];
        }
        sum = sum_of_warp(sum) * inverse;
        product = sum_of_warp(product) * inverse;
        for (int c = 0; c < columns; ++c) {
            const int column = c * lanes + threadIdx.x;
            if (column >= norm.width) break;
            const float value = scale * (d[c] - sum - values[c] * product);
            dh[r * norm.width + column] = value;
            biases[c] += value;
        }
    }
    add_columns(gammas, norm.width, d_gamma);
    add_columns(betas, norm.width, d_beta);
    add_columns(biases, norm.width, d_bias);
}

/// Calls launch.operator()<columns> with the columns per lane that `width` needs.
template <typename Launch>
int with_columns(std::int64_t rows, int width, const Launch& launch) {
    if (rows == 0) return 0;
    const dim3 blocks(static_cast<unsigned>(blocks_for(rows))), threads(lanes, warps);
    if (width <= lanes)
        launch.template operator()<1>(blocks, threads);
    else if (width <= 2 * lanes)
        launch.template operator()<2>(blocks, threads);
    else if (width <= 4 * lanes)
        launch.template operator()<4>(blocks, threads);
    else
        launch.template operator()<most_columns>(blocks, threads);
    return static_cast<int>(cudaGetLastError());
}

struct FirstLayerBackward {
    FirstLayer layer;
    const float* h;
    float *g, *dx, *dp0, *dp1, *d_bias;
    template <int columns>
    void operator()(dim3 blocks, dim3 threads) const {
        first_layer_backward_kernel<columns>
            <<<blocks, threads>>>(layer, h, g, dx, dp0, dp1, d_bias);
    }
};

struct ReluBackward {
    std::int64_t rows;
    int width;
    const float* h;
    float *g, *d_bias;
    template <int columns>
    void operator()(dim3 blocks, dim3 threads) const {
        relu_backward_kernel<columns><<<blocks, threads>>>(rows, width, h, g, d_bias);
    }
};

struct NormAndAdd {
    Norm norm;
    float *out, *sum;
    template <int columns>
    void operator()(dim3 blocks, dim3 threads) const {
        norm_and_add_kernel<columns><<<blocks, threads>>>(norm, out, sum);
    }
};

struct NormBackward {
    Norm norm;
    const float *d_out, *d_sum;
    float *dh, *d_gamma, *d_beta, *d_bias;
    template <int columns>
    void operator()(dim3 blocks, dim3 threads) const {
        norm_backward_kernel<columns>
            <<<blocks, threads>>>(norm, d_out, d_sum, dh, d_gamma, d_beta, d_bias);
    }
};

}  // namespace

int first_layer(const FirstLayer& layer, float* h) {
    if (layer.rows == 0) return 0;
    first_layer_kernel<<<static_cast<unsigned>(blocks_for(layer.rows)), dim3(lanes, warps)>>>(layer,
                                                                                              h);
    return static_cast<int>(cudaGetLastError());
}

int first_layer_backward(const FirstLayer& layer, const float* h, float* g, float* dx,
                         float* const dp[2], float* d_bias) {
    return with_columns(layer.rows, layer.width,
                        FirstLayerBackward{layer, h, g, dx, dp[0], dp[1], d_bias});
}

int relu_backward(std::int64_t rows, int width, const float* h, float* g, float* d_bias) {
    return with_columns(rows, width, ReluBackward{rows, width, h, g, d_bias});
}

int norm_and_add(const Norm& norm, float* out, float* sum) {
    return with_columns(norm.rows, norm.width, NormAndAdd{norm, out, sum});
}

int norm_backward(const Norm& norm, const float* d_out, const float* d_sum, float* dh,
                  float* d_gamma, float* d_beta, float* d_bias) {
    return with_columns(norm.rows, norm.width,
                        NormBackward{norm, d_out, d_sum, dh, d_gamma, d_beta, d_bias});
}

}  // namespace cloth::cuda
