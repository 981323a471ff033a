#pragma once

#include <vector>

#include "gnn/train/message_op.h"

namespace cloth {

/// message_op on a GPU, with kernels of its own for all that is no matrix product. Built with
/// CLOTH_CUDA; without it no tensor is supported. Sums over rows are in no fixed order: bits
/// differ from run to run.
FusedOutput cuda_message_block(const std::vector<torch::Tensor>& x,
                               const std::vector<torch::Tensor>& products,
                               const FusedWeights& weights, const MessageTable& table,
                               bool with_out);

/// Whether the operation can take this tensor: CUDA, float32, at most 512 columns.
bool cuda_block_supports(const torch::Tensor& latent);

}  // namespace cloth
