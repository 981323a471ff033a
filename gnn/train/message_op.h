#pragma once

#include <torch/torch.h>

#include <memory>
#include <vector>

#include "gnn/train/fused_block.h"

namespace cloth {

/// Parameters of a multilayer perceptron with a split first layer.
struct MlpWeights {
    std::vector<torch::Tensor> first;  ///< per input (D x inputs)
    torch::Tensor first_bias;
    std::vector<torch::Tensor> hidden, hidden_bias;      ///< per further hidden layer (D x D), (D)
    torch::Tensor output, output_bias, norm, norm_bias;  ///< norm undefined: no LayerNorm
};

/// Index tables of a message block on the device of its tensors; see FusedRows for the meaning.
struct MessageTable {
    explicit MessageTable(FusedRows rows, torch::Device device);

    std::shared_ptr<const FusedRows> rows;
    torch::Tensor x_index, product_index[2], sum_index;  ///< int64, undefined: row r
};

/// Everything after the first layer's sum: (rows x D) -> (rows x outputs).
torch::Tensor mlp_tail(const MlpWeights& weights, const torch::Tensor& first);

/// The whole perceptron on one input.
torch::Tensor mlp(const MlpWeights& weights, const torch::Tensor& input);

/// One message block (gnn/model/message_block.h) whose direct inputs x belong to the first-layer
/// weights numbered `inputs`. Takes the fused operation where it can, else LibTorch's own.
FusedOutput message_op(const std::vector<torch::Tensor>& x, const std::vector<int>& inputs,
                       const std::vector<torch::Tensor>& products, const MlpWeights& weights,
                       const MessageTable& table, bool with_out);

/// The same with LibTorch's operations alone: for other devices and types, and for the tests.
FusedOutput message_op_plain(const std::vector<torch::Tensor>& x, const std::vector<int>& inputs,
                             const std::vector<torch::Tensor>& products, const MlpWeights& weights,
                             const MessageTable& table, bool with_out);

}  // namespace cloth
