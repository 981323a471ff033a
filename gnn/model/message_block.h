#pragma once

#include <vector>

namespace cloth {

/// The one computation that a MeshGraphNets processor repeats, fused over tiles of rows:
///
///     h1 = relu(sum_k W1_k x_k[row] + sum_k p_k[row] + b1)    x: direct inputs, p: given products
///     h2 = relu(W2 h1 + b2)
///     m  = LayerNorm(W3 h2 + b3)
///     out[row] = x_0[row] + m,   sum[receiver] += scale m
///
/// An edge update has the edge latent as x_0 and the products A v_receiver, B v_sender as p (split
/// first layer); a node update has the node latent and the summed messages as x. Temporaries of a
/// tile stay in cache; the backward pass computes them again instead of storing them.
///
/// Single-threaded; rows are processed in order, so results do not depend on anything else.
struct MessageBlockWeights {
    static constexpr int max_inputs = 3;
    int width = 0;                                  ///< D, a multiple of 16
    int inputs = 0;                                 ///< number of direct inputs, 1 to 3
    int in[max_inputs] = {};                        ///< their widths, multiples of 16
    const float* w1[max_inputs] = {};               ///< each (D x in[k])
    const float* b1 = nullptr;                      ///< (D)
    const float *w2 = nullptr, *b2 = nullptr;       ///< (D x D), (D)
    const float *w3 = nullptr, *b3 = nullptr;       ///< (D x D), (D)
    const float *gamma = nullptr, *beta = nullptr;  ///< LayerNorm's (D)
};

/// Which rows of which matrices a block reads and writes. A null index means row r itself.
struct MessageBlockRows {
    int rows = 0;
    const float* x[MessageBlockWeights::max_inputs] = {};      ///< each (* x in[k])
    const int* x_index[MessageBlockWeights::max_inputs] = {};  ///< (rows)
    int products = 0;                                          ///< 0 to 2
    const float* p[2] = {};                                    ///< each (* x D)
    const int* p_index[2] = {};                                ///< (rows)
    const int* sum_index = nullptr;                            ///< (rows): receiver of the message
    float sum_scale = 1.0f;
};

/// Gradients with the shapes of what they belong to; all are added to, null ones are skipped.
/// `x` and `p` follow the index tables of the rows.
struct MessageBlockGradients {
    float* x[MessageBlockWeights::max_inputs] = {};
    float* p[2] = {};
    float* w1[MessageBlockWeights::max_inputs] = {};
    float *b1 = nullptr, *w2 = nullptr, *b2 = nullptr, *w3 = nullptr, *b3 = nullptr;
    float *gamma = nullptr, *beta = nullptr;
};

using MessageBlockScratch = std::vector<float>;  ///< grown on first use, then reused

/// @param out  residual output, indexed like x[0] (x_0 + m), or null; may be x[0] itself
/// @param sum  summed messages (* x D), added to, or null
void message_block_forward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                           float* out, float* sum, MessageBlockScratch& scratch);

/// @param d_out  gradient of `out` (indexed like x[0]), or null. The residual's own share of it is
///               not added to gradients.x[0]: the caller starts that gradient as a copy of d_out.
/// @param d_sum  gradient of `sum`, or null
void message_block_backward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                            const float* d_out, const float* d_sum,
                            const MessageBlockGradients& gradients, MessageBlockScratch& scratch);

/// y = x W' + b, with relu if asked for: one layer for rows that need no fusion.
/// @param x       (rows x in)
/// @param weight  (out x in); out a multiple of 16
/// @param bias    (out), or null
/// @param y       (rows x out)
void dense_layer(int rows, int in, int out, const float* x, const float* weight, const float* bias,
                 bool with_relu, float* y, MessageBlockScratch& scratch);

/// The same forward pass as plain loops: the oracle of the tests.
void message_block_forward_plain(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                                 float* out, float* sum);

}  // namespace cloth
