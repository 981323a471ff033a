#pragma once

#include <cstddef>

#include "gnn/model/aligned_buffer.h"

namespace cloth {

/// Packed matrices in one of two precisions: one pointer is set, or none.
struct Panels {
    Panels() = default;
    Panels(const float* numbers) : float32(numbers) {}
    Panels(const Bfloat16* numbers) : bfloat16(numbers) {}
    explicit operator bool() const { return float32 || bfloat16; }
    const float* float32 = nullptr;
    const Bfloat16* bfloat16 = nullptr;
};

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
/// Single-threaded; rows are processed in order, and a row's numbers do not depend on the rows
/// beside it.
struct MessageBlockWeights {
    static constexpr int max_inputs = 4;
    int width = 0;                                  ///< D, a multiple of 16
    int inputs = 0;                                 ///< number of direct inputs, 1 to 4
    int in[max_inputs] = {};                        ///< their widths, multiples of 16
    const float* w1[max_inputs] = {};               ///< each (D x in[k])
    const float* b1 = nullptr;                      ///< (D)
    const float *w2 = nullptr, *b2 = nullptr;       ///< (D x D), (D)
    const float *w3 = nullptr, *b3 = nullptr;       ///< (D x D), (D)
    const float *gamma = nullptr, *beta = nullptr;  ///< LayerNorm's (D)

    /// pack_block()'s result: the forward pass then needs no w1, w2, w3. None: packed in each call,
    /// as float32.
    Panels panels;
};

/// Which rows of which matrices a block reads and writes. A null index means row r itself.
struct MessageBlockRows {
    int rows = 0;
    const float* x[MessageBlockWeights::max_inputs] = {};      ///< each (* x in[k]); null: zeros
                                                               ///< (all but x[0], forward only)
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

using MessageBlockScratch = AlignedBuffer;  ///< grown on first use, then reused

/// Instruction sets that the loops are compiled for.
/// avx512_bf16 multiplies bfloat16 at twice the rate of float32; the others widen it first and gain
/// nothing but memory. Its float32 numbers are those of avx512.
enum class Instructions { portable, avx2, avx512, avx512_bf16 };
bool is_supported(Instructions instructions);  ///< by this processor
Instructions best_instructions();

/// A matrix (out x in) as the forward pass reads it: panels of 32 outputs, input by input.
/// @param out, in  multiples of 16
/// @param panels   out * in numbers; in bfloat16 an output's numbers of two inputs lie side by side
void pack_panels(const float* weight, int out, int in, float* panels);
void pack_panels(const float* weight, int out, int in, Bfloat16* panels);

/// Count of a block's panel numbers, and the panels: w1[0], ..., w2, w3. In bfloat16 w3 is stored
/// less the mean of its rows, so that LayerNorm finds a mean of zero.
std::size_t block_panel_count(const MessageBlockWeights& weights);
void pack_block(const MessageBlockWeights& weights, float* panels);
void pack_block(const MessageBlockWeights& weights, Bfloat16* panels);

/// In the precision of the panels.
/// @param out  residual output, indexed like x[0] (x_0 + m), or null; may be x[0] itself
/// @param sum  summed messages (* x D), added to, or null
void message_block_forward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                           float* out, float* sum, MessageBlockScratch& scratch,
                           Instructions instructions = best_instructions());

/// In float32 only.
/// @param d_out  gradient of `out` (indexed like x[0]), or null. The residual's own share of it is
///               not added to gradients.x[0]: the caller starts that gradient as a copy of d_out.
/// @param d_sum  gradient of `sum`, or null
void message_block_backward(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                            const float* d_out, const float* d_sum,
                            const MessageBlockGradients& gradients, MessageBlockScratch& scratch,
                            Instructions instructions = best_instructions());

/// y = x W' + b, with relu if asked for: one layer for rows that need no fusion.
/// @param x       (rows x in)
/// @param panels  of the weight (out x in), from pack_panels()
/// @param bias    (out), or null
/// @param y       (rows x out)
void dense_layer(int rows, int in, int out, const float* x, Panels panels, const float* bias,
                 bool with_relu, float* y, MessageBlockScratch& scratch,
                 Instructions instructions = best_instructions());

/// The same forward pass as plain loops in float32: the oracle of the tests.
void message_block_forward_plain(const MessageBlockWeights& weights, const MessageBlockRows& rows,
                                 float* out, float* sum);

}  // namespace cloth
