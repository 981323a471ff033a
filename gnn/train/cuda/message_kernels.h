#pragma once

#include <cstdint>

// The parts of a message block (gnn/model/message_block.h) that are no matrix products, on a GPU,
// on the default stream. Matrices are row-major with `width` columns, 1 to 512, and lie in the
// memory of the GPU. Index tables may be null: row r. All return the last CUDA error, 0 for none.
namespace cloth::cuda {

struct FirstLayer {
    std::int64_t rows = 0;
    int width = 0;
    const float* x = nullptr;               ///< product of the input that has an index
    const std::int64_t* x_index = nullptr;  ///< (rows)
    const float* rest = nullptr;  ///< (rows x width) products of inputs without one, or null
    const float* p[2] = {};       ///< given products, or null
    const std::int64_t* p_index[2] = {};  ///< (rows)
    const float* bias = nullptr;          ///< (width)
};

/// h = relu(x[x_index] + rest + p0[p_index0] + p1[p_index1] + bias)
int first_layer(const FirstLayer& layer, float* h);

/// The reverse, in place: g becomes g where h > 0, else 0, is added to the rows of dx, dp0, dp1
/// that were read, and summed over its rows into d_bias.
/// @param dx, dp  null: not wanted; those without an index are not written, g is their gradient
int first_layer_backward(const FirstLayer& layer, const float* h, float* g, float* dx,
                         float* const dp[2], float* d_bias);

/// In place: g becomes g where h > 0, else 0, and is summed over its rows into d_bias.
int relu_backward(std::int64_t rows, int width, const float* h, float* g, float* d_bias);

struct Norm {
    std::int64_t rows = 0;
    int width = 0;
    const float* h = nullptr;  ///< (rows x width)
    const float *gamma = nullptr, *beta = nullptr;
    const std::int64_t *x_index = nullptr, *sum_index = nullptr;  ///< (rows)
    float sum_scale = 1.0f;
};

/// m = LayerNorm(h); out[x_index] += m; sum[sum_index] += sum_scale m.
/// @param out, sum  null: not wanted
int norm_and_add(const Norm& norm, float* out, float* sum);

/// The gradient of h from those of out and sum, either may be null; d_gamma, d_beta, and d_bias,
/// the sum of dh over its rows, are added to.
int norm_backward(const Norm& norm, const float* d_out, const float* d_sum, float* dh,
                  float* d_gamma, float* d_beta, float* d_bias);

}  // namespace cloth::cuda
