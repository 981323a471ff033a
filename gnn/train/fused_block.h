#pragma once

#include <torch/torch.h>

#include <memory>
#include <vector>

namespace cloth {

/// Index tables of a message block; see gnn/model/message_block.h for what it computes.
struct FusedRows {
    int rows = 0;
    std::vector<int> x_index;           ///< (rows) rows of x[0], or empty: row r
    std::vector<int> product_index[2];  ///< (rows) rows of the products, or empty: row r
    std::vector<int> sum_index;         ///< (rows) receivers, or empty: row r
    int sums = 0;                       ///< number of receivers
    float sum_scale = 1.0f;
};

/// Parameters of a block; undefined tensors stand for absent inputs.
struct FusedWeights {
    torch::Tensor w1[4];  ///< each (D x in[k])
    torch::Tensor b1, w2, b2, w3, b3, gamma, beta;
};

struct FusedOutput {
    torch::Tensor
        out;  ///< x_0 with the messages added at the rows that were read (rows of x_0 x D)
    torch::Tensor sum;  ///< summed messages (sums x D)
};

/// message_block as a differentiable LibTorch operation: float32, CPU, single-threaded, widths that
/// are multiples of 16. Nothing but its inputs is stored for the backward pass.
///
/// @param x         1 to 4 direct inputs (* x in[k]); x[0] is the residual's base if `with_out`
/// @param products  0 to 2 given products (* x D)
/// @param with_out  false: `out` is not computed (undefined)
FusedOutput fused_message_block(const std::vector<torch::Tensor>& x,
                                const std::vector<torch::Tensor>& products,
                                const FusedWeights& weights, std::shared_ptr<const FusedRows> rows,
                                bool with_out);

/// Whether the fused operation can take this tensor: CPU, float32, width a multiple of 16.
bool fused_block_supports(const torch::Tensor& latent);

}  // namespace cloth
